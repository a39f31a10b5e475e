#pragma once

#include "scene/scene.hpp"
#include "support.hpp"

namespace apeiron::test {

/// A catalogue with two fake subjects, so that no test depends on a particular formula.
inline std::shared_ptr<const scene::Catalogue> catalogueWithFakes() {
    using namespace parameter;
    Parameter power;
    power.name = "power";
    power.defaultValue = 8.0;
    power.minimum = 2;
    power.maximum = 16;
    Parameter formula;
    formula.name = "formula";
    formula.type = Type::Module;
    formula.folder = "formulas";
    formula.defaultValue = ModuleReference{"plain", "uniform float bend; //! 1 [0, 2]"};
    auto catalogue = std::make_shared<scene::Catalogue>();
    catalogue->add({"subject", "fake", "A fake", {power, formula}, {}});
    catalogue->add({"subject", "other", "Another fake", {}, {}});
    catalogue->add({"slot", "", "A fake slot", {formula}, {}});
    return catalogue;
}

} // namespace apeiron::test
