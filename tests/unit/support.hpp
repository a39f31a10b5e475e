#pragma once

#include "../temporary_folder.hpp"
#include "core/error.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

namespace apeiron::test {

/// The message of the Error that `action` throws; "no error" when it does not.
template <class F> std::string messageOf(const F& action) {
    try {
        action();
    } catch (const Error& error) {
        return error.what();
    }
    return "no error";
}

} // namespace apeiron::test
