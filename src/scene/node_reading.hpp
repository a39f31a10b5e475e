#pragma once

#include "core/error.hpp"
#include "scene/catalogue.hpp"

#include <functional>
#include <span>

namespace apeiron::scene {

/// What reading a part of a document needs besides its JSON.
struct ReadContext {
    const Catalogue& catalogue;
    std::function<std::string(const std::string& pointer)> where; ///< a JSON pointer's place, for messages
    std::filesystem::path base;                                   ///< what paths are relative to
};

/// The node that a JSON object describes; keys that are missing have their defaults.
/// @param pointer   where the object stands in the document
/// @param otherKeys keys that the caller reads itself
/// @throws Error (BadInput, Io) at the offending value's place.
parameter::Node readNode(const ReadContext& context, std::string_view role, const Json& json,
                         const std::string& pointer, std::span<const std::string> otherKeys = {});

/// The nodes of a JSON array. @throws Error (BadInput, Io), also for more than `limit` of them.
std::vector<parameter::Node> readNodes(const ReadContext& context, std::string_view role, const Json& json,
                                       const std::string& pointer, std::size_t limit);

/// @throws Error (BadInput) when the value is no object.
void requireObject(const ReadContext& context, const Json& json, const std::string& pointer);

/// "at most 8 lights are possible" as an Error. @param role "light"
Error tooMany(std::string_view role, std::size_t limit);

} // namespace apeiron::scene
