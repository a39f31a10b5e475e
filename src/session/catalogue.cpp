#include "session/subjects.hpp"

#include "fractal/fractal.hpp"
#include "session/session.hpp"
#include "terrain/terrain.hpp"
#include "volume/volume_subject.hpp"

namespace apeiron::session {

const std::vector<render::SubjectType>& subjectTypes() {
    // The one place that knows all subjects; the first is the default.
    static const std::vector<render::SubjectType> kTypes{fractal::subjectType(), volume::subjectType(),
                                                         terrain::subjectType()};
    return kTypes;
}

std::shared_ptr<const scene::Catalogue> catalogue() {
    static const std::shared_ptr<const scene::Catalogue> kCatalogue = [] {
        auto all = std::make_shared<scene::Catalogue>();
        for (const render::SubjectType& type : subjectTypes()) {
            all->add(type.node);
            for (const parameter::NodeType& part : type.parts)
                all->add(part);
        }
        return all;
    }();
    return kCatalogue;
}

} // namespace apeiron::session
