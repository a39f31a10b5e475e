#include "scene/own_types.hpp"

namespace apeiron::scene {
namespace {

using parameter::Decimal3;
using parameter::Invalidates;
using parameter::ModuleReference;
using parameter::NodeType;
using parameter::Parameter;
using parameter::Type;
using parameter::Value;

/// Builds a host parameter piece by piece, so that declarations read as one line each.
class Declare {
  public:
    Declare(std::string name, Type type, Value defaultValue, std::string doc) {
        parameter_.name = std::move(name);
        parameter_.type = type;
        parameter_.defaultValue = std::move(defaultValue);
        parameter_.doc = std::move(doc);
    }

    Declare& range(double minimum, double maximum) {
        parameter_.minimum = minimum;
        parameter_.maximum = maximum;
        return *this;
    }
    Declare& step(double step) { return parameter_.step = step, *this; }
    Declare& unit(std::string unit) { return parameter_.unit = std::move(unit), *this; }
    Declare& choices(std::vector<std::string> labels) { return parameter_.choices = std::move(labels), *this; }
    Declare& folder(std::string folder) { return parameter_.folder = std::move(folder), *this; }
    Declare& invalidates(Invalidates what) { return parameter_.invalidates = what, *this; }
    Declare& color() { return parameter_.color = true, *this; }
    Declare& logarithmic() { return parameter_.logarithmic = true, *this; }
    Declare& nonZero() { return parameter_.nonZero = true, *this; }

    operator Parameter() const { return parameter_; } // NOLINT: converting is what it is for

  private:
    Parameter parameter_;
};

Value decimals(const char* x, const char* y, const char* z) {
    return Decimal3{Decimal::parse(x), Decimal::parse(y), Decimal::parse(z)};
}

NodeType camera() {
    return {
        "camera",
        "",
        "Where the picture is taken from",
        {
            Declare("mode", Type::Choice, "orbit", "Look at the target, or along a free orientation")
                .choices({"orbit", "free"}),
            Declare("position", Type::Decimal3, decimals("1.52", "-2.34", "0.98"), "Where the camera is"),
            Declare("target", Type::Decimal3, decimals("0", "0", "0"),
                    "What it looks at and turns around in orbit mode"),
            Declare("up", Type::Vec3, glm::dvec3(0, 0, 1), "The direction that is upwards in the picture in orbit mode")
                .nonZero(),
            Declare("roll", Type::Float, 0.0, "Counter-clockwise turn around the view direction in orbit mode")
                .range(-180, 180)
                .unit("deg"),
            Declare("orientation", Type::Vec4, glm::dvec4(0, 0, 0, 1),
                    "Camera to world in free mode: a quaternion x, y, z, w")
                .nonZero(),
            Declare("fov", Type::Float, 46.0, "Vertical field of view").range(1, 150).unit("deg"),
            Declare("projection", Type::Choice, "perspective",
                    "Orthographic shows at the target what the perspective would: 2 distance tan(fov/2) of height")
                .choices({"perspective", "orthographic"})
                .invalidates(Invalidates::Samples),
            Declare(
                "aperture", Type::Float, 0.0,
                "Diameter of the lens in units of the focal distance, so that zooming keeps the look; 0: everything "
                "is sharp")
                .range(0, 1)
                .step(0.005)
                .invalidates(Invalidates::Samples),
            Declare("focus", Type::Float, 0.0, "Distance of the plane that is sharp; 0: the target's")
                .range(0, 1e6)
                .logarithmic()
                .invalidates(Invalidates::Samples),
            Declare("blades", Type::Int, std::int64_t{0}, "Blades of the lens' iris; fewer than 3: round")
                .range(0, 16)
                .invalidates(Invalidates::Samples),
            Declare("filter", Type::Choice, "gaussian", "Pixel filter for anti-aliasing")
                .choices({"box", "tent", "gaussian"})
                .invalidates(Invalidates::Samples),
        },
        {},
    };
}

NodeType sun() {
    return {
        "light",
        "sun",
        "Light from infinitely far away",
        {
            // From behind and to the left of the default camera, so that forms show in light and shadow.
            Declare("azimuth", Type::Float, 250.0, "Direction of the sun, from +x towards +y")
                .range(-360, 360)
                .unit("deg"),
            Declare("elevation", Type::Float, 40.0, "Height of the sun above the horizon").range(-90, 90).unit("deg"),
            Declare("color", Type::Vec3, glm::dvec3(1, 0.95, 0.85), "Colour of the light").range(0, 1).color(),
            Declare("intensity", Type::Float, 3.0, "Irradiance on a surface that faces the sun")
                .range(0, 1000)
                .logarithmic(),
            Declare("size", Type::Float, 0.53, "Angular diameter; 0: perfectly sharp shadows").range(0, 90).unit("deg"),
        },
        {},
    };
}

NodeType point() {
    return {
        "light",
        "point",
        "Light from a small sphere",
        {
            Declare("position", Type::Decimal3, decimals("1", "-1.5", "2"), "Centre of the sphere"),
            Declare("color", Type::Vec3, glm::dvec3(1, 0.95, 0.85), "Colour of the light").range(0, 1).color(),
            Declare("intensity", Type::Float, 10.0, "Radiant intensity").range(0, 1e6).logarithmic(),
            Declare("radius", Type::Float, 0.05, "Radius of the sphere; 0: perfectly sharp shadows")
                .range(0, 1e3)
                .logarithmic(),
        },
        {},
    };
}

NodeType rectangle() {
    return {
        "light",
        "rectangle",
        "Light from the front of a rectangle that shines evenly: a lamp of the studio, a window",
        {
            Declare("position", Type::Decimal3, decimals("1", "-1.5", "2"), "Centre of the rectangle"),
            Declare("target", Type::Decimal3, decimals("0", "0", "0"), "Where its front looks"),
            Declare("roll", Type::Float, 0.0, "Turn around that direction; at 0 the height is as upright as it can be")
                .range(-180, 180)
                .unit("deg"),
            Declare("width", Type::Float, 1.0, "Width of the rectangle").range(1e-6, 1e6).logarithmic(),
            Declare("height", Type::Float, 1.0, "Height of the rectangle").range(1e-6, 1e6).logarithmic(),
            Declare("color", Type::Vec3, glm::dvec3(1, 0.95, 0.85), "Colour of the light").range(0, 1).color(),
            Declare(
                "intensity", Type::Float, 10.0,
                "Radiant intensity straight ahead: radiance times area. Sizes change shadows, not brightness; power is "
                "intensity times pi")
                .range(0, 1e9)
                .logarithmic(),
            Declare("visible", Type::Bool, false,
                    "The camera sees it, too, in raymarch, pathtrace, mcs and mcm; what is behind shines through"),
        },
        {},
    };
}

NodeType environment() {
    return {
        "environment",
        "",
        "Light from all around",
        {
            Declare("type", Type::Module, ModuleReference{"sky", {}}, "What surrounds the scene")
                .folder("environments")
                .invalidates(Invalidates::Program),
            Declare("intensity", Type::Float, 1.0, "Factor on the environment's radiance").range(0, 1000).logarithmic(),
            Declare("rotation", Type::Float, 0.0, "Turn around +z").range(-360, 360).unit("deg"),
            Declare("background", Type::Choice, "environment", "What is seen where there is no surface")
                .choices({"environment", "transparent"}),
        },
        {},
    };
}

NodeType renderer() {
    return {
        "renderer",
        "",
        "How light is computed",
        {Declare("type", Type::Module, ModuleReference{"raymarch", {}}, "The method")
             .folder("renderers")
             .invalidates(Invalidates::Program)},
        {},
    };
}

NodeType post() {
    return {
        "post",
        "",
        "From radiance to the picture",
        {
            Declare("exposure", Type::Float, 0.0, "Exposure compensation; each step doubles the brightness")
                .range(-20, 20)
                .unit("EV")
                .invalidates(Invalidates::Present),
            Declare("exposure_mode", Type::Choice, "manual",
                    "By hand, or measured on the picture so that its average luminance is `key`; `exposure` then "
                    "compensates")
                .choices({"manual", "auto"})
                .invalidates(Invalidates::Present),
            Declare("key", Type::Float, 0.18, "Average luminance that automatic exposure aims at")
                .range(0.01, 1)
                .logarithmic()
                .invalidates(Invalidates::Present),
            // Present: the post chain's kernels are compiled anew, the samples stay.
            Declare("tonemapper", Type::Module, ModuleReference{"reinhard", {}}, "From radiance to display values")
                .folder("tonemappers")
                .invalidates(Invalidates::Present),
        },
        {},
    };
}

NodeType effect() {
    return {
        "effect",
        "",
        "One step of the post chain",
        {
            Declare("type", Type::Module, ModuleReference{"vignette", {}}, "What it does")
                .folder("effects")
                .invalidates(Invalidates::Present),
            Declare("enabled", Type::Bool, true, "Off: the picture passes unchanged").invalidates(Invalidates::Present),
        },
        {},
    };
}

NodeType output() {
    const auto count = [](std::int64_t value) { return Value(value); };
    return {
        "output",
        "",
        "The picture's size and when it is finished",
        {
            Declare("width", Type::Int, count(960), "Picture width").range(1, 32768).unit("px"),
            Declare("height", Type::Int, count(540), "Picture height").range(1, 32768).unit("px"),
            Declare("samples", Type::Int, count(64), "Stop after so many samples per pixel")
                .range(1, 1e7)
                .logarithmic()
                .invalidates(Invalidates::Nothing),
            Declare("noise", Type::Float, 0.0, "Stop when the estimated relative error is below; 0: never")
                .range(0, 1)
                .invalidates(Invalidates::Nothing),
            Declare("time", Type::Float, 0.0, "Stop after so much time; 0: never")
                .range(0, 1e6)
                .unit("s")
                .invalidates(Invalidates::Nothing),
            Declare("seed", Type::Int, count(0), "Start of all random numbers").range(0, 4294967295.0),
            Declare("first_sample", Type::Int, count(0),
                    "Index of the first sample, to divide the samples between machines")
                .range(0, 1e9),
        },
        {},
    };
}

} // namespace

std::vector<NodeType> ownTypes() {
    return {camera(), renderer(), sun(), point(), rectangle(), environment(), post(), effect(), output()};
}

} // namespace apeiron::scene
