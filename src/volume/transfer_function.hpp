#pragma once

#include "core/json.hpp"
#include "core/math.hpp"
#include "parameter/parameter.hpp"

#include <span>
#include <string>
#include <vector>

namespace apeiron::volume {

/// Where the values of one channel lie, in value units (after slope and intercept).
struct DataRange {
    double minimum = 0.0; ///< of all voxels
    double maximum = 1.0;
    double low = 0.0; ///< a window that shows the object: robust against outliers and without the empty background
    double high = 1.0;
    double gradientHigh = 1.0; ///< a gradient magnitude that few voxels exceed [value/mm]
};

/// A place of a transfer function: the light of a material whose voxels have that value. Colours are linear RGB.
struct TransferPoint {
    double value = 0.0; ///< in value units, or 0 to 1 across the window
    glm::dvec3 color{1.0};
    double opacity = 0.0;  ///< 0 to 1: the extinction in parts of the subject's density
    double emission = 0.0; ///< radiance that the material sends out by itself, times the colour
};

/// A region of the plane of value × gradient magnitude, which tells boundaries from the inside of materials.
struct TransferShape {
    enum class Kind {
        Box,      ///< constant inside the rectangle
        Gaussian, ///< exp(-d²/2) with standard deviations of half the size
        Triangle, ///< Levoy 1988, eq. 3: from an apex at the bottom upwards, falling off to both sides; fits an arc
    };
    Kind kind = Kind::Box;
    glm::dvec2 center{0.5, 0.5}; ///< value and gradient magnitude; of a triangle, the middle of its height
    glm::dvec2 size{0.2, 0.2};   ///< whole width and height
    glm::dvec3 color{1.0};
    double opacity = 1.0;
    double emission = 0.0;
};

/// How values become colour and opacity. Between points everything is linear, in linear light; beyond the first and
/// the last it is constant. Shapes add to the points, each with its colour in proportion to its opacity.
struct TransferFunction {
    enum class Window {
        None,  ///< points and shapes are in value units (Hounsfield units of a CT), gradients in value/mm
        Given, ///< they are 0 to 1 across level ± width/2, gradients 0 to 1 up to the data's gradientHigh
        Data,  ///< the same, across low to high of the data
    };
    Window window = Window::Data;
    double level = 0.0; ///< the middle of the window
    double width = 1.0; ///< of the window, above 0
    std::vector<TransferPoint> points;
    std::vector<TransferShape> shapes;

    bool twoDimensional() const { return !shapes.empty(); }
};

/// A transfer function as a texture has it.
///
/// Texel x stands for the value low + (high - low) x / (width - 1): the ends are exact, so look up at texel coordinate
/// u (width - 1), and clamp. Row y stands for the gradient magnitude gradientHigh y / (height - 1).
struct TransferTable {
    int width = 0;
    int height = 1; ///< 1 where gradients have no part in it
    double low = 0.0;
    double high = 1.0;
    double gradientHigh = 1.0;
    std::vector<float> rgba;     ///< linear RGB and opacity of each texel, rows from gradient 0 upwards
    std::vector<float> emission; ///< radiance as RGB of each texel; empty where nothing glows
};

constexpr int kTransferValues = 1024; ///< texels of a function of the value
constexpr int kTransferSquare = 256;  ///< texels each way of a function of value × gradient magnitude
constexpr std::size_t kMaxPoints = 256;
constexpr std::size_t kMaxShapes = 64;

/// A preset: a transfer function for a kind of data, `volume/presets/NAME.json`:
///
///     { "doc": "...", "modality": "ct", "transfer": ... }
struct TransferPreset {
    std::string name;
    std::string doc;
    std::string modality; ///< "ct", "mri", "microscopy", "simulation" or "any"
    Json transfer;        ///< a function, or a list of one for each channel
};

/// All presets, sorted by name. @throws Error (BadInput) when a file is wrong.
const std::vector<TransferPreset>& transferPresets();

/// Checks the JSON of a `transfer` parameter. @throws Error (BadInput) that says where inside it something is wrong.
///
///     "auto" | PRESET | FUNCTION | [FUNCTION or PRESET for channel 0, ...]
///     FUNCTION = { "preset": PRESET,            what the other keys replace parts of
///                  "space": "srgb" | "linear",  what colours are written in; "srgb" where it is not said
///                  "window": "data" | "none" | {"level": L, "width": W},
///                  "points": [ {"value", "color", "opacity", "emission"}, ... ],   in ascending order of values
///                  "shapes": [ {"type": "box" | "gaussian" | "triangle", "center": [v, g], "size": [w, h],
///                               "color", "opacity", "emission"}, ... ] }
///
/// A color is [r, g, b] from 0 to 1, or "#rrggbb", which always is sRGB.
void checkTransfer(const Json& json);

/// The functions that a `transfer` parameter's JSON names, at least one, one per channel; fewer: the last holds for the
/// rest. @param automatic what "auto" stands for (see automaticTransfer()) @throws Error (BadInput) as checkTransfer().
std::vector<TransferFunction> transferFunctions(const Json& json, const Json& automatic);

/// A function as checkTransfer() takes it, with all that it says written out.
Json toJson(const TransferFunction& function);

/// The function with its points and shapes in value units. @param range of the channel that it is for
TransferFunction inValueUnits(const TransferFunction& function, const DataRange& range);

/// The texels of a function. Its domain is where the function and the data have something to say, so that a narrow
/// window has all texels. @param square whether it must have rows for gradients
TransferTable transferTable(const TransferFunction& function, const DataRange& range, bool square);

/// One table for each channel's range, all of the same size. @param functions as transferFunctions() has them
std::vector<TransferTable> transferTables(std::span<const TransferFunction> functions,
                                          std::span<const DataRange> ranges);

/// Colour and opacity at a value and gradient magnitude, in the function's own units. The truth behind the tables.
TransferPoint evaluate(const TransferFunction& function, double value, double gradient);

/// The declaration of a parameter that holds a transfer function.
parameter::Parameter transferParameter();

} // namespace apeiron::volume
