#pragma once

#include "core/error.hpp"

namespace apeiron::parameter {

/// Throws a BadInput error whose place the callers add.
[[noreturn]] inline void fail(const std::string& what, const std::string& hint = {}) {
    throw Error(ErrorKind::BadInput, what, {}, hint);
}

} // namespace apeiron::parameter
