#include "volume_files.hpp"

#include <fmt/format.h>

#include <array>

namespace apeiron::test {
namespace {

/// A file that grows, in one byte order.
class Bytes {
  public:
    explicit Bytes(bool bigEndian = false) : bigEndian_(bigEndian) {}
    template <class T> void put(T value) { text_ += bytesOf(std::vector<T>{value}, bigEndian_); }
    template <class T> void putAt(std::size_t place, T value) {
        text_.replace(place, sizeof(T), bytesOf(std::vector<T>{value}, bigEndian_));
    }
    void add(std::string_view text) { text_ += text; }
    void fillTo(std::size_t size) { text_.resize(size, '\0'); }
    std::size_t size() const { return text_.size(); }
    const std::string& text() const { return text_; }

  private:
    std::string text_;
    bool bigEndian_;
};

std::uint32_t crc32(std::string_view bytes) {
    std::uint32_t crc = 0xFFFFFFFFU;
    for (const char c : bytes) {
        crc ^= static_cast<unsigned char>(c);
        for (int bit = 0; bit < 8; ++bit)
            crc = (crc >> 1) ^ (0xEDB88320U & (0U - (crc & 1U)));
    }
    return ~crc;
}

/// RFC 1951, 3.2.4.
void addStored(Bytes& file, std::string_view bytes) {
    constexpr std::size_t kMost = 65535;
    do {
        const std::string_view block = bytes.substr(0, kMost);
        bytes.remove_prefix(block.size());
        file.put<std::uint8_t>(bytes.empty() ? 1 : 0);
        file.put(static_cast<std::uint16_t>(block.size()));
        file.put(static_cast<std::uint16_t>(~block.size()));
        file.add(block);
    } while (!bytes.empty());
}

/// A DICOM element of a short value representation (PS3.5, 7.1.2).
void element(Bytes& file, std::uint16_t group, std::uint16_t number, const char* vr, std::string value) {
    const bool isLong = std::string_view(vr) == "OW" || std::string_view(vr) == "OB";
    if (value.size() % 2 != 0) value += std::string_view(vr) == "UI" || isLong ? '\0' : ' ';
    file.put(group);
    file.put(number);
    file.add(vr);
    if (isLong) {
        file.put<std::uint16_t>(0);
        file.put(static_cast<std::uint32_t>(value.size()));
    } else {
        file.put(static_cast<std::uint16_t>(value.size()));
    }
    file.add(value);
}

std::string us(int value) {
    return bytesOf(std::vector<std::uint16_t>{static_cast<std::uint16_t>(value)});
}

} // namespace

std::string bytesOf(const volume::Volume& volume) {
    return {reinterpret_cast<const char*>(volume.voxels.data()), volume.voxels.size()};
}

std::string gzip(std::string_view bytes) {
    Bytes file;
    file.add(std::string_view("\x1f\x8b\x08\0\0\0\0\0\0\xff", 10));
    addStored(file, bytes);
    file.put(crc32(bytes));
    file.put(static_cast<std::uint32_t>(bytes.size()));
    return file.text();
}

std::string zlib(std::string_view bytes) {
    Bytes file;
    file.add("\x78\x01");
    addStored(file, bytes);
    std::uint32_t a = 1; // Adler-32
    std::uint32_t b = 0;
    for (const char c : bytes) {
        a = (a + static_cast<unsigned char>(c)) % 65521;
        b = (b + a) % 65521;
    }
    Bytes sum(true);
    sum.put((b << 16) | a);
    return file.text() + sum.text();
}

bool says(const volume::Volume& volume, std::string_view part) {
    return std::any_of(volume.messages.begin(), volume.messages.end(),
                       [part](const std::string& message) { return message.find(part) != std::string::npos; });
}

glm::dvec3 placeOf(const volume::Volume& volume, glm::dvec3 voxel) {
    return {volume.indexToWorld * glm::dvec4(voxel, 1)};
}

// https://nifti.nimh.nih.gov/pub/dist/src/niftilib/nifti1.h
std::string niftiFile(const Nifti& header, std::string_view voxels) {
    Bytes file(header.bigEndian);
    file.put<std::int32_t>(348);
    file.fillTo(352);
    file.putAt(40, static_cast<std::int16_t>(header.dim.size()));
    for (std::size_t i = 0; i < 7; ++i)
        file.putAt(42 + 2 * i, i < header.dim.size() ? header.dim[i] : std::int16_t{1});
    file.putAt(70, header.datatype);
    file.putAt(72, header.bits);
    file.putAt(76, header.qfac);
    for (std::size_t i = 0; i < header.pixdim.size(); ++i)
        file.putAt(80 + 4 * i, header.pixdim[i]);
    file.putAt(108, 352.0F);
    file.putAt(112, header.slope);
    file.putAt(116, header.intercept);
    file.putAt<std::int8_t>(123, 2 + 8); // mm, s
    if (!header.quaternion.empty()) {
        file.putAt<std::int16_t>(252, 1);
        for (std::size_t i = 0; i < 6; ++i)
            file.putAt(256 + 4 * i, header.quaternion[i]);
    }
    if (!header.sform.empty()) {
        file.putAt<std::int16_t>(254, 1);
        for (std::size_t i = 0; i < 12; ++i)
            file.putAt(280 + 4 * i, header.sform[i]);
    }
    std::string text = file.text();
    text.replace(344, 4, std::string_view("n+1\0", 4));
    return text + std::string(voxels);
}

std::string dicomFile(const DicomSlice& slice) {
    constexpr const char* kCtStorage = "1.2.840.10008.5.1.4.1.1.2";
    constexpr const char* kMrStorage = "1.2.840.10008.5.1.4.1.1.4";
    const char* const storage = slice.modality == "MR" ? kMrStorage : kCtStorage;
    const auto vector = [](const glm::dvec3& v) { return fmt::format("{}\\{}\\{}", v.x, v.y, v.z); };
    const std::string instance = fmt::format("{}.{}", slice.series, slice.instance);

    Bytes meta;
    element(meta, 2, 0x01, "OB", std::string("\0\1", 2));
    element(meta, 2, 0x02, "UI", storage);
    element(meta, 2, 0x03, "UI", instance);
    element(meta, 2, 0x10, "UI", "1.2.840.10008.1.2.1");
    Bytes file;
    file.fillTo(128);
    file.add("DICM");
    element(file, 2, 0, "UL", bytesOf(std::vector<std::uint32_t>{static_cast<std::uint32_t>(meta.size())}));
    file.add(meta.text());
    element(file, 0x08, 0x16, "UI", storage);
    element(file, 0x08, 0x18, "UI", instance);
    element(file, 0x08, 0x60, "CS", slice.modality);
    element(file, 0x20, 0x0d, "UI", "1.2.3");
    element(file, 0x20, 0x0e, "UI", slice.series);
    element(file, 0x20, 0x13, "IS", std::to_string(slice.instance));
    element(file, 0x20, 0x32, "DS", vector(slice.position));
    element(file, 0x20, 0x37, "DS", vector(slice.row) + "\\" + vector(slice.column));
    element(file, 0x28, 0x02, "US", us(1));
    element(file, 0x28, 0x04, "CS", "MONOCHROME2");
    element(file, 0x28, 0x10, "US", us(slice.rows));
    element(file, 0x28, 0x11, "US", us(slice.columns));
    // The distance of rows first (PS3.3, 10.7.1.3).
    element(file, 0x28, 0x30, "DS", fmt::format("{}\\{}", slice.spacing.y, slice.spacing.x));
    element(file, 0x28, 0x100, "US", us(slice.bits));
    element(file, 0x28, 0x101, "US", us(slice.bits));
    element(file, 0x28, 0x102, "US", us(slice.bits - 1));
    element(file, 0x28, 0x103, "US", us(slice.isSigned ? 1 : 0));
    element(file, 0x28, 0x1052, "DS", fmt::format("{}", slice.intercept));
    element(file, 0x28, 0x1053, "DS", fmt::format("{}", slice.slope));
    element(file, 0x7fe0, 0x10, slice.bits > 8 ? "OW" : "OB", slice.pixels);
    return file.text();
}

// TIFF revision 6.0, section 2.
std::string tiffFile(const Tiff& tiff) {
    Bytes file(tiff.bigEndian);
    file.add(tiff.bigEndian ? "MM" : "II");
    file.put<std::uint16_t>(42);
    file.put<std::uint32_t>(0);
    std::size_t link = 4; // where the place of the next page has to be put
    for (std::size_t page = 0; page < tiff.pages.size(); ++page) {
        const std::size_t pixels = file.size();
        file.add(tiff.pages[page]);
        const std::size_t text = file.size();
        const std::string description = page == 0 ? tiff.description : "";
        file.add(description);
        file.put<std::uint8_t>(0);
        // Values of every sample, where there are too many to be in the tag itself.
        const std::size_t bits = file.size();
        for (int i = 0; i < tiff.samples; ++i)
            file.put(static_cast<std::uint16_t>(tiff.bits));
        const std::size_t formats = file.size();
        for (int i = 0; i < tiff.samples; ++i)
            file.put(static_cast<std::uint16_t>(tiff.format));
        const std::size_t resolution = file.size();
        file.put(static_cast<std::uint32_t>(tiff.resolution * 1000.0));
        file.put<std::uint32_t>(1000);
        if (file.size() % 2 != 0) file.put<std::uint8_t>(0);

        struct Tag {
            std::uint16_t number;
            std::uint16_t type; ///< 2 text, 3 short, 4 long, 5 rational
            std::size_t count;
            std::size_t value;
        };
        const auto samples = static_cast<std::size_t>(tiff.samples);
        const bool inside = samples == 1;
        std::vector<Tag> tags{{256, 3, 1, static_cast<std::size_t>(tiff.width)},
                              {257, 3, 1, static_cast<std::size_t>(tiff.height)},
                              {258, 3, samples, inside ? static_cast<std::size_t>(tiff.bits) : bits},
                              {259, 3, 1, 1},
                              {262, 3, 1, samples >= 3 ? 2U : 1U}};
        if (!description.empty()) tags.push_back({270, 2, description.size() + 1, text});
        tags.push_back({273, 4, 1, pixels});
        tags.push_back({277, 3, 1, samples});
        tags.push_back({278, 3, 1, static_cast<std::size_t>(tiff.height)});
        tags.push_back({279, 4, 1, tiff.pages[page].size()});
        if (tiff.resolution > 0) {
            tags.push_back({282, 5, 1, resolution});
            tags.push_back({283, 5, 1, resolution});
        }
        tags.push_back({284, 3, 1, 1});
        if (tiff.resolution > 0) tags.push_back({296, 3, 1, 1});
        tags.push_back({339, 3, samples, inside ? static_cast<std::size_t>(tiff.format) : formats});

        file.putAt(link, static_cast<std::uint32_t>(file.size()));
        file.put(static_cast<std::uint16_t>(tags.size()));
        for (const Tag& tag : tags) {
            file.put(tag.number);
            file.put(tag.type);
            file.put(static_cast<std::uint32_t>(tag.count));
            if (tag.type == 3 && tag.count == 1) {
                file.put(static_cast<std::uint16_t>(tag.value));
                file.put<std::uint16_t>(0);
            } else {
                file.put(static_cast<std::uint32_t>(tag.value));
            }
        }
        link = file.size();
        file.put<std::uint32_t>(0);
    }
    return file.text();
}

} // namespace apeiron::test
