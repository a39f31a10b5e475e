#include "../unit/support.hpp"
#include "io/volume_kind.hpp"
#include "io/volume_stream.hpp"
#include "io/volumes/serve.hpp"
#include "volume/raw.hpp"
#include "volume_files.hpp"

#include <fmt/format.h>
#include <openvdb/openvdb.h>

#include <cstdlib>
#include <fcntl.h>
#include <fstream>
#include <memory>
#include <random>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

// Damaged files, 10,000 of them. Each is read as front ends do, by volumes::serve() in a process of its own; to save
// the time that starting a program takes, that process is a copy of this one.
namespace apeiron::io::volumes {
namespace {

using namespace apeiron::test; // NOLINT: it is all about these

constexpr std::size_t kVoxels = std::size_t{4} << 20; ///< most bytes that a file may ask for
constexpr unsigned kSeconds = 5;                      ///< nothing here takes a hundredth of that

struct Outcome {
    bool isVolume = false;
    std::string error;
    int ending = 0;  ///< a reader's Ending, or -1 where a signal ended it
    long memory = 0; ///< most that it had at once [KiB]
};

Outcome attempt(const std::filesystem::path& file, unsigned seconds) {
    std::array<int, 2> ends{};
    if (::pipe2(ends.data(), O_CLOEXEC) != 0) throw Error(ErrorKind::Io, "no pipe");
    const pid_t process = ::fork();
    if (process == 0) {
        // Libraries' own chatter goes nowhere.
        const int nowhere = ::open("/dev/null", O_WRONLY);
        ::dup2(nowhere, STDOUT_FILENO);
        ::dup2(nowhere, STDERR_FILENO);
        ::close(ends[0]);
        _exit(static_cast<int>(serve({file, {}, {}, 0}, {kVoxels, seconds}, ends[1])));
    }
    ::close(ends[1]);
    Outcome outcome;
    std::FILE* from = ::fdopen(ends[0], "rb");
    try {
        const volume::Volume volume = receiveVolume(from, kVoxels);
        outcome.isVolume = true;
        if (volume.voxels.size() !=
            volume::byteSize(volume.size, volume.type, volume.channels, volume.timePoints, kVoxels))
            outcome.error = "voxels are missing";
    } catch (const Error& error) {
        outcome.error = error.at(file.filename().string()).what();
    }
    std::fclose(from);
    int status = 0;
    rusage used{};
    ::wait4(process, &status, 0, &used);
    outcome.ending = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
    outcome.memory = used.ru_maxrss;
    return outcome;
}

/// Damages files in all the ways that happen to them, and in those that hurt most.
class Damage {
  public:
    explicit Damage(unsigned seed) : random_(seed) {}

    std::string operator()(std::string file) {
        const int count = 1 + below(3);
        for (int i = 0; i < count; ++i)
            damage(file);
        return file;
    }

  private:
    int below(std::size_t n) { return static_cast<int>(random_() % std::max<std::size_t>(n, 1)); }
    /// Headers are at the beginning, mostly.
    std::size_t place(const std::string& file) {
        const std::size_t most = below(4) == 0 ? file.size() : std::min<std::size_t>(file.size(), 700);
        return static_cast<std::size_t>(below(most));
    }
    void damage(std::string& file) {
        if (file.empty()) return;
        static const std::vector<std::string> kWords{"0",     "-1",         "1",          "99999999999999999999",
                                                     "65536", "2147483648", "1e308",      "nan",
                                                     "",      "-0.0",       "4294967295", "x",
                                                     "%s%n",  "(",          "\n"};
        constexpr std::array<std::uint64_t, 8> kNumbers{0,          1,          0x7F,       0xFF,
                                                        0x7FFFFFFF, 0xFFFFFFFF, 0x80000000, 0x7FFFFFFFFFFFFFFF};
        const std::size_t at = place(file);
        switch (below(7)) {
        case 0: // cut off
            file.resize(below(2) == 0 ? at : static_cast<std::size_t>(below(file.size())));
            break;
        case 1: // a bit
            file[at] = static_cast<char>(file[at] ^ (1 << below(8)));
            break;
        case 2: // a byte
            file[at] = static_cast<char>(random_());
            break;
        case 3: { // a number of the text
            const std::size_t begin = file.find_first_of("0123456789", at);
            if (begin == std::string::npos) break;
            const std::size_t end = std::min(file.find_first_not_of("0123456789.", begin), file.size());
            file.replace(begin, end - begin, kWords[static_cast<std::size_t>(below(kWords.size()))]);
            break;
        }
        case 4: { // a binary number, in either byte order
            const std::size_t width = std::size_t{1} << below(4);
            std::string bytes =
                bytesOf(std::vector<std::uint64_t>{kNumbers[static_cast<std::size_t>(below(8))]}).substr(0, width);
            if (below(2) == 0) std::reverse(bytes.begin(), bytes.end());
            file.replace(at, width, bytes);
            break;
        }
        case 5: // a part is lost
            file.erase(at, static_cast<std::size_t>(1 + below(20)));
            break;
        default: // a part comes twice
            file.insert(place(file), file.substr(at, static_cast<std::size_t>(1 + below(20))));
            break;
        }
    }

    std::mt19937 random_;
};

/// Whole files of a kind, small ones.
struct Corpus {
    std::string name; ///< of the file that is damaged
    std::vector<std::string> files;
    std::vector<std::pair<std::string, std::string>> beside; ///< in the same folder, whole
    bool folder = false;                                     ///< the folder is what is read
    /// OpenVDB 10 counts to 2^32 where a number of its tree is wrong: that ends at the limit of time, with an error.
    bool mayLoop = false;
};

class FuzzTest : public testing::Test {
  protected:
    /// Reads `count` damaged files. All end well: with a volume or an error of one clear line, soon, and in little
    /// memory.
    void run(const Corpus& corpus, int count, unsigned seed) {
        const std::filesystem::path file = folder_ / corpus.name;
        for (const auto& [name, bytes] : corpus.beside)
            writeFile(folder_ / name, bytes);
        const auto write = [&](const std::string& bytes) { std::ofstream(file, std::ios::binary) << bytes; };
        const std::filesystem::path& what = corpus.folder ? folder_.path() : file;
        // What a reader may take (see serve.cpp), and what this process has.
        rusage own{};
        getrusage(RUSAGE_SELF, &own);
        const long memory = own.ru_maxrss + static_cast<long>(3 * kVoxels / 1024) + 1024 * 1024;
        const unsigned seconds = corpus.mayLoop ? 1 : kSeconds;
        for (const std::string& whole : corpus.files) {
            write(whole);
            const Outcome outcome = attempt(what, seconds);
            ASSERT_TRUE(outcome.isVolume) << outcome.error;
        }
        Damage damage(seed);
        int volumes = 0;
        int crashes = 0;
        for (int i = 0; i < count; ++i) {
            const std::string bytes = damage(corpus.files[static_cast<std::size_t>(i) % corpus.files.size()]);
            write(bytes);
            // Front ends do not even ask for what is of no kind.
            if (!corpus.folder && !volumeKind(what)) continue;
            const Outcome outcome = attempt(what, seconds);
            const auto fine = [&] {
                if (outcome.ending == static_cast<int>(Ending::TooLong) && !corpus.mayLoop) return false;
                if (outcome.ending < 0) return false;
                if (outcome.memory > memory) return false;
                if (outcome.isVolume) return outcome.error.empty();
                return outcome.error.size() > 10 && outcome.error.size() < 500 &&
                       outcome.error.find('\n') == std::string::npos;
            };
            if (!fine()) {
                // To be looked at afterwards.
                const std::filesystem::path kept =
                    std::filesystem::temp_directory_path() / ("apeiron-fuzz-" + corpus.name);
                std::ofstream(kept, std::ios::binary) << bytes;
                ADD_FAILURE() << "case " << i << ", kept as " << kept << ": ending " << outcome.ending << ", "
                              << outcome.memory << " KiB, " << outcome.error.substr(0, 600);
                return;
            }
            volumes += outcome.isVolume ? 1 : 0;
            crashes += outcome.ending == static_cast<int>(Ending::Crashed) ? 1 : 0;
        }
        RecordProperty("volumes", volumes);
        RecordProperty("crashes_that_became_errors", crashes);
        // Else nothing was damaged, or nothing was left to be read.
        EXPECT_LT(volumes, count);
    }

    TemporaryFolder folder_;
};

std::string voxels(std::size_t bytes = 48) {
    std::string text;
    for (std::size_t i = 0; i < bytes; ++i)
        text += static_cast<char>(i * 37);
    return text;
}

std::string nrrd(const std::string& more, const std::string& data) {
    return "NRRD0004\ntype: short\ndimension: 3\nspace: left-posterior-superior\nsizes: 4 3 2\n"
           "space directions: (1,0,0) (0,2,0) (0,0,3)\nkinds: domain domain domain\nendian: little\n"
           "space origin: (0,0,0)\n" +
           more + "\n" + data;
}

std::string meta(const std::string& more, const std::string& data) {
    return "ObjectType = Image\nNDims = 3\nBinaryData = True\nBinaryDataByteOrderMSB = False\n"
           "TransformMatrix = 1 0 0 0 1 0 0 0 1\nOffset = 1 2 3\nCenterOfRotation = 0 0 0\n"
           "AnatomicalOrientation = RAI\nElementSpacing = 1 2 3\nDimSize = 4 3 2\nElementType = MET_SHORT\n" +
           more + data;
}

std::string nifti(std::vector<float> sform = {}) {
    Nifti header;
    header.dim = {4, 3, 2};
    header.datatype = 4;
    header.bits = 16;
    header.sform = std::move(sform);
    header.quaternion = {0, 0, 0, 1, 2, 3};
    return niftiFile(header, voxels());
}

std::string slice(int number) {
    DicomSlice one;
    one.instance = number;
    one.position.z = number;
    one.intercept = -1024;
    one.isSigned = false;
    one.pixels = voxels(24);
    return dicomFile(one);
}

Tiff tiff(const std::string& description) {
    Tiff file;
    file.description = description;
    file.resolution = 2;
    file.pages = {4, voxels(12)};
    return file;
}

constexpr const char* kOme =
    "<?xml version=\"1.0\"?><OME xmlns=\"http://www.openmicroscopy.org/Schemas/OME/2016-06\"><Image "
    "ID=\"Image:0\"><Pixels "
    "ID=\"Pixels:0\" DimensionOrder=\"XYCZT\" Type=\"uint8\" SizeX=\"4\" SizeY=\"3\" SizeZ=\"2\" SizeC=\"2\" "
    "SizeT=\"1\" "
    "PhysicalSizeX=\"0.5\" PhysicalSizeXUnit=\"um\" TimeIncrement=\"2\"><Channel ID=\"a\" Name=\"DAPI\"/><TiffData "
    "IFD=\"0\" "
    "FirstZ=\"0\" FirstC=\"0\" FirstT=\"0\" PlaneCount=\"4\"/></Pixels></Image></OME>";
constexpr const char* kImageJ = "ImageJ=1.53t\nimages=4\nchannels=2\nslices=2\nunit=um\nspacing=1.5\nfinterval=1\n";

TEST_F(FuzzTest, nrrd) {
    run({"a.nrrd", {nrrd("encoding: raw\n", voxels()), nrrd("encoding: gzip\n", gzip(voxels()))}, {}, false}, 1750, 1);
}

TEST_F(FuzzTest, nrrd_with_a_header_of_its_own) {
    run({"a.nhdr",
         {nrrd("encoding: raw\ndata file: voxels.raw\n", ""),
          nrrd("encoding: raw\ndata file: slice%d.raw 1 2 1 2\n", ""),
          nrrd("encoding: raw\ndata file: LIST\nslice1.raw\nslice2.raw", "")},
         {{"voxels.raw", voxels()}, {"slice1.raw", voxels(24)}, {"slice2.raw", voxels(24)}},
         false},
        1000, 2);
}

TEST_F(FuzzTest, metaimage) {
    const std::string packed = zlib(voxels());
    run({"a.mha",
         {meta("ElementDataFile = LOCAL\n", voxels()),
          meta(fmt::format("CompressedData = True\nCompressedDataSize = {}\nElementDataFile = LOCAL\n", packed.size()),
               packed)},
         {},
         false},
        1500, 3);
}

TEST_F(FuzzTest, metaimage_with_a_header_of_its_own) {
    run({"a.mhd",
         {meta("ElementDataFile = voxels.raw\n", ""), meta("ElementDataFile = LIST\nslice1.raw\nslice2.raw\n", "")},
         {{"voxels.raw", voxels()}, {"slice1.raw", voxels(24)}, {"slice2.raw", voxels(24)}},
         false},
        1000, 4);
}

TEST_F(FuzzTest, nifti) {
    run({"a.nii", {nifti(), nifti({1, 0, 0, 5, 0, 2, 0, 6, 0, 0, 3, 7})}, {}, false}, 1000, 5);
}

TEST_F(FuzzTest, nifti_compressed) {
    run({"a.nii.gz", {gzip(nifti())}, {}, false}, 500, 6);
}

TEST_F(FuzzTest, dicom) {
    run({"a.dcm", {slice(1)}, {}, false}, 750, 7);
}

TEST_F(FuzzTest, dicom_series) {
    run({"1.dcm", {slice(1)}, {{"0.dcm", slice(0)}, {"2.dcm", slice(2)}}, true}, 750, 8);
}

TEST_F(FuzzTest, tiff) {
    Tiff big = tiff("");
    big.bigEndian = true;
    run({"a.tif", {tiffFile(tiff(kOme)), tiffFile(tiff(kImageJ)), tiffFile(big)}, {}, false}, 1500, 9);
}

TEST_F(FuzzTest, openvdb) {
    // TBB's threads would be missing in copies of this process: what starts them is done in one.
    const std::filesystem::path whole = folder_ / "whole.vdb";
    const pid_t process = ::fork();
    if (process == 0) {
        openvdb::initialize();
        auto grid = openvdb::FloatGrid::create(0.0F);
        grid->setName("density");
        grid->getAccessor().setValue({0, 0, 0}, 1.0F);
        grid->getAccessor().setValue({9, 8, 7}, 2.0F);
        openvdb::io::File(whole.string()).write({grid});
        _exit(0);
    }
    ::waitpid(process, nullptr, 0);
    const std::string bytes = readFile(whole);
    std::filesystem::remove(whole);
    run({"a.vdb", {bytes}, {}, false, true}, 250, 10);
}

TEST_F(FuzzTest, bare_voxels) {
    const std::vector<std::string> forms{"4x3x2:uint16:big:offset=16:channels=2:times=3:spacing=0.5x0.5x1.2",
                                         "4x3x2:float32"};
    Damage damage(11);
    int refused = 0;
    for (int i = 0; i < 2000; ++i) {
        const std::string form = damage(forms[static_cast<std::size_t>(i) % forms.size()]);
        const std::string problem = messageOf([&] { volume::fromRaw(volume::parseRawForm(form), voxels(400)); });
        refused += problem == "no error" ? 0 : 1;
        EXPECT_EQ(problem.find('\n'), std::string::npos) << form;
        EXPECT_LT(problem.size(), 500U) << form;
    }
    EXPECT_GT(refused, 1000);
}

} // namespace
} // namespace apeiron::io::volumes
