#pragma once

#include <nlohmann/json.hpp>

namespace apeiron {

/// JSON that keeps the order of keys, so that saved scenes read as they were written.
using Json = nlohmann::ordered_json;

} // namespace apeiron
