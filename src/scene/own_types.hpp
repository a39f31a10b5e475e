#pragma once

#include "parameter/node.hpp"

namespace apeiron::scene {

/// The node types that every scene has: camera, lights, environment, renderer, post chain, effects, output.
std::vector<parameter::NodeType> ownTypes();

} // namespace apeiron::scene
