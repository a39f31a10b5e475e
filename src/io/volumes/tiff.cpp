#include "core/error.hpp"
#include "io/volumes/elements.hpp"
#include "io/volumes/tiff_pages.hpp"
#include "io/volumes/volumes.hpp"
#include "io/volumes/whole.hpp"

#include <OpenImageIO/imageio.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <memory>

namespace apeiron::io::volumes {
namespace {

namespace fs = std::filesystem;
using OIIO::ImageInput;
using OIIO::ImageSpec;
using OIIO::TypeDesc;
using volume::Volume;

std::unique_ptr<ImageInput> openedPicture(const fs::path& file) {
    auto input = ImageInput::create("tiff");
    ImageSpec spec;
    ImageSpec wishes;
    wishes.attribute("oiio:UnassociatedAlpha", 1); // a channel is a channel
    if (input == nullptr || !input->open(file.string(), spec, wishes)) {
        const std::string why = input != nullptr ? input->geterror() : OIIO::geterror();
        throw Error(ErrorKind::Io, "is a damaged TIFF file: " + inOneLine(why.substr(0, why.find('\n'))));
    }
    return input;
}

Element elementOf(const ImageSpec& spec) {
    switch (spec.format.basetype) {
    case TypeDesc::UINT8:
        return Element::UInt8;
    case TypeDesc::INT8:
        return Element::Int8;
    case TypeDesc::UINT16:
        return Element::UInt16;
    case TypeDesc::INT16:
        return Element::Int16;
    case TypeDesc::HALF:
        return Element::Float16;
    case TypeDesc::FLOAT:
        return Element::Float32;
    case TypeDesc::UINT32:
        return Element::UInt32;
    case TypeDesc::INT32:
        return Element::Int32;
    case TypeDesc::DOUBLE:
        return Element::Float64;
    default:
        throw Error(ErrorKind::Io, "its pixels are of a type that is not understood");
    }
}

/// A page of a file.
struct Page {
    std::size_t file = 0;
    int number = 0;
};

/// Pages that look like the first one, in order.
struct Pages {
    std::vector<Page> pages;
    ImageSpec first;
    std::string description;
};

bool alike(const ImageSpec& a, const ImageSpec& b) {
    return a.width == b.width && a.height == b.height && a.nchannels == b.nchannels && a.format == b.format;
}

Pages pagesOf(const std::vector<fs::path>& files, Volume& volume) {
    // A chain of pages may lead back to its beginning.
    constexpr int kMostPages = 1'000'000;
    Pages result;
    std::size_t others = 0;
    for (std::size_t file = 0; file < files.size(); ++file) {
        const std::unique_ptr<ImageInput> input = openedPicture(files[file]);
        const std::size_t promised = tiffPageCount(files[file]);
        int number = 0;
        for (; number < kMostPages && input->seek_subimage(number, 0); ++number) {
            const ImageSpec spec = input->spec_dimensions(number);
            if (result.pages.empty()) {
                result.first = input->spec(number);
                result.description = result.first.get_string_attribute("ImageDescription");
            }
            if (result.pages.empty() || alike(spec, result.first)) {
                result.pages.push_back({file, number});
            } else {
                ++others;
            }
        }
        // What follows a page that cannot be read is not lost without a word.
        if (static_cast<std::size_t>(number) < promised)
            throw Error(ErrorKind::Io, fmt::format("page {} is damaged", number + 1));
    }
    if (result.pages.empty()) throw Error(ErrorKind::Io, "has no pages");
    if (others > 0)
        volume.messages.push_back(fmt::format("{} pages of another size or type than the first were left out", others));
    return result;
}

/// Reads pages in any order, best in theirs.
class PageReader {
  public:
    PageReader(const std::vector<fs::path>& files, const ImageSpec& spec) : files_(files), spec_(spec) {}

    void read(const Page& page, std::byte* to) {
        if (input_ == nullptr || file_ != page.file) {
            input_ = openedPicture(files_[page.file]);
            file_ = page.file;
        }
        if (!input_->read_image(page.number, 0, 0, spec_.nchannels, spec_.format, to)) {
            const std::string why = input_->geterror();
            throw Error(ErrorKind::Io, fmt::format("page {} is damaged: {}", page.number + 1,
                                                   inOneLine(why.substr(0, why.find('\n')))));
        }
    }

  private:
    const std::vector<fs::path>& files_;
    const ImageSpec& spec_;
    std::unique_ptr<ImageInput> input_;
    std::size_t file_ = 0;
};

/// All pages are slices.
PageOrder plainOrder(int pageCount) {
    PageOrder order;
    order.sizeZ = pageCount;
    for (int i = 0; i < pageCount; ++i)
        order.pages.push_back(i);
    return order;
}

void setSpacing(Volume& volume, PageOrder order, const ImageSpec& spec) {
    if (order.spacing.x < 0) {
        // ImageJ: pixels per unit in the resolution tags.
        const double unit = -order.spacing.x;
        const double x = spec.get_float_attribute("XResolution", 0.0F);
        const double y = spec.get_float_attribute("YResolution", static_cast<float>(x));
        order.spacing.x = x > 0 ? unit / x : 0;
        order.spacing.y = y > 0 ? unit / y : 0;
    }
    glm::dvec3 spacing = order.spacing;
    for (int axis = 0; axis < 3; ++axis)
        if (!std::isfinite(spacing[axis]) || spacing[axis] < 0) spacing[axis] = 0;
    const double known = std::max({spacing.x, spacing.y, spacing.z});
    if (known <= 0) {
        volume.messages.emplace_back("the size of its voxels is not told: taken as 1 mm");
        spacing = glm::dvec3(1);
    } else if (spacing.x <= 0 || spacing.y <= 0 || spacing.z <= 0) {
        volume.messages.emplace_back(
            "the size of its voxels is told for some directions only: taken as the same for all");
        const double least = spacing.x > 0 ? spacing.x : known;
        for (int axis = 0; axis < 3; ++axis)
            if (spacing[axis] <= 0) spacing[axis] = least;
    }
    // Rows go down and slices away from who looks: turned about x, writing in the picture can be read from above.
    volume::centre(volume, spacing * glm::dvec3(1.0, -1.0, -1.0));
}

} // namespace

Volume readTiff(const std::vector<fs::path>& files, std::size_t limit) {
    Volume volume;
    const Pages pages = pagesOf(files, volume);
    const ImageSpec& spec = pages.first;
    const auto samples = static_cast<std::size_t>(spec.nchannels);
    const int pageCount = static_cast<int>(pages.pages.size());
    const PageOrder order =
        files.size() > 1 ? plainOrder(pageCount)
                         : pageOrder(pages.description, pageCount, spec.nchannels).value_or(plainOrder(pageCount));
    if (order.sizeX > 0 && (order.sizeX != spec.width || order.sizeY != spec.height))
        throw Error(ErrorKind::Io, fmt::format("its OME-XML promises {}x{} pixels, and its pages have {}x{}",
                                               order.sizeX, order.sizeY, spec.width, spec.height));
    if (spec.width < 1 || spec.height < 1 || spec.depth > 1) throw Error(ErrorKind::Io, "its pages are not pictures");

    const Element element = elementOf(spec);
    Shape shape{static_cast<std::uint64_t>(spec.width), static_cast<std::uint64_t>(spec.height),
                static_cast<std::uint64_t>(order.sizeZ), samples * static_cast<std::uint64_t>(order.sizeC),
                static_cast<std::uint64_t>(order.sizeT)};
    shape.channels = keptChannels(shape.channels, volume);
    std::vector<std::byte> elements(requireMemory(shape, element, limit));
    const std::size_t width = bytesOf(element);
    const std::size_t plane = shape.x * shape.y * width;
    std::vector<std::byte> page(plane * samples);
    PageReader reader(files, spec);
    std::size_t missing = 0;
    const auto sizeC = static_cast<std::size_t>(order.sizeC);
    const auto sizeZ = static_cast<std::size_t>(order.sizeZ);
    for (std::size_t t = 0; t < shape.times; ++t)
        for (std::size_t c = 0; c < sizeC && c * samples < shape.channels; ++c)
            for (std::size_t z = 0; z < sizeZ; ++z) {
                const int number = order.pages[(t * sizeC + c) * sizeZ + z];
                if (number < 0) {
                    ++missing;
                    continue;
                }
                reader.read(pages.pages[static_cast<std::size_t>(number)], page.data());
                for (std::size_t s = 0; s < samples && c * samples + s < shape.channels; ++s) {
                    std::byte* to = elements.data() + ((t * shape.channels + c * samples + s) * shape.z + z) * plane;
                    if (samples == 1) {
                        std::memcpy(to, page.data(), plane);
                        continue;
                    }
                    for (std::size_t i = 0; i < shape.x * shape.y; ++i)
                        std::memcpy(to + i * width, page.data() + (i * samples + s) * width, width);
                }
            }
    if (missing > 0) volume.messages.push_back(fmt::format("{} planes are not in the file: they are 0", missing));
    setVoxels(volume, shape, element, std::move(elements));
    setSpacing(volume, order, spec);
    volume.timeStep = order.timeStep;
    volume.channelNames = order.channelNames;
    volume.channelNames.resize(std::min(volume.channelNames.size(), static_cast<std::size_t>(volume.channels)));
    if (order.isOme) volume.modality = volume::Modality::Microscopy;
    return volume;
}

} // namespace apeiron::io::volumes
