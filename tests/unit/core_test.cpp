#include "core/file.hpp"
#include "core/resources.hpp"
#include "core/suggest.hpp"
#include "support.hpp"

#include <vector>

namespace apeiron {
namespace {

using test::messageOf;
using test::TemporaryFolder;
using testing::HasSubstr;

namespace fs = std::filesystem;

const std::vector<std::string> kNames{"power", "iterations", "bailout", "fov"};

std::size_t filesIn(const fs::path& folder) {
    return static_cast<std::size_t>(std::distance(fs::directory_iterator(folder), {}));
}

TEST(ErrorTest, message_has_place_then_reason_then_hint) {
    EXPECT_STREQ(Error(ErrorKind::BadInput, "is wrong", "a.json:3", "try b").what(), "a.json:3: is wrong; try b");
    EXPECT_STREQ(Error(ErrorKind::Io, "is wrong").what(), "is wrong");
}

TEST(ErrorTest, wider_place_goes_in_front_and_kind_stays) {
    const Error error = Error(ErrorKind::Gpu, "lost", "inner").at("outer");
    EXPECT_STREQ(error.what(), "outer: inner: lost");
    EXPECT_EQ(error.kind(), ErrorKind::Gpu);
}

TEST(ErrorTest, quoted_text_is_short_and_printable) {
    EXPECT_EQ(inQuotes("abc"), "\"abc\"");
    EXPECT_EQ(inQuotes("a\nb"), "\"a?b\"");
    EXPECT_LE(inQuotes(std::string(1000, 'x')).size(), 62U);
    EXPECT_THAT(inQuotes("\xC3\xA4" + std::string(55, 'x') + "\xC3\xA4\xC3\xA4\xC3\xA4"), HasSubstr("x...\""));
}

TEST(SuggestTest, near_slip_is_suggested) {
    EXPECT_EQ(nearestName("pwoer", kNames), "power"); // swapped neighbours
    EXPECT_EQ(nearestName("iteration", kNames), "iterations");
    EXPECT_EQ(nearestName("fvo", kNames), "fov");
    EXPECT_EQ(suggestion("pwoer", kNames), "did you mean 'power'?");
}

TEST(SuggestTest, case_does_not_matter) {
    EXPECT_EQ(nearestName("BAILOUT", kNames), "bailout");
}

TEST(SuggestTest, far_name_gets_the_list_instead) {
    EXPECT_EQ(nearestName("colour", kNames), "");
    EXPECT_EQ(suggestion("colour", kNames), "known: power, iterations, bailout, fov");
    EXPECT_EQ(suggestion("x", {}), "");
}

TEST(SuggestTest, long_list_is_shortened) {
    std::vector<std::string> many;
    for (int i = 0; i < 100; ++i)
        many.push_back("candidate" + std::to_string(i));
    EXPECT_THAT(suggestion("zzz", many), HasSubstr(", ... (100 in all)"));
}

TEST(FileTest, written_content_reads_back) {
    const TemporaryFolder folder;
    const std::string content("with \0 and \n", 12);
    writeFile(folder / "a.bin", content);
    EXPECT_EQ(readFile(folder / "a.bin"), content);
    writeFile(folder / "a.bin", "");
    EXPECT_EQ(readFile(folder / "a.bin"), "");
    EXPECT_EQ(filesIn(folder.path()), 1U);
}

TEST(FileTest, missing_folder_and_too_large_files_are_errors_that_name_the_file) {
    const TemporaryFolder folder;
    EXPECT_THAT(messageOf([&] { readFile(folder / "no.txt"); }), HasSubstr("no.txt: cannot be read: No such file"));
    EXPECT_THAT(messageOf([&] { readFile(folder.path()); }), HasSubstr("is a folder"));
    EXPECT_THAT(messageOf([&] { writeFile(folder / "no/a.txt", ""); }), HasSubstr("does not exist"));
    EXPECT_THAT(messageOf([&] { requireWritable(folder.path()); }), HasSubstr("is a folder"));
    writeFile(folder / "big", "12345");
    EXPECT_THAT(messageOf([&] { readFile(folder / "big", 4); }), HasSubstr("larger than 4 bytes"));
    EXPECT_EQ(readFile(folder / "big", 5), "12345");
}

TEST(FileTest, failed_write_leaves_the_old_file_and_nothing_else) {
    const TemporaryFolder folder;
    writeFile(folder / "a.txt", "old");
    const auto failing = [](const fs::path& temporary) {
        writeFile(temporary, "half");
        throw Error(ErrorKind::Io, "stopped");
    };
    EXPECT_EQ(messageOf([&] { writeAtomically(folder / "a.txt", failing); }), "stopped");
    EXPECT_EQ(readFile(folder / "a.txt"), "old");
    EXPECT_EQ(filesIn(folder.path()), 1U);
    EXPECT_THAT(messageOf([&] { writeAtomically(folder / "b.txt", [](const fs::path&) {}); }),
                HasSubstr("b.txt: cannot be written"));
}

TEST(FileTest, temporary_file_has_the_extension_and_folder_of_the_final_one) {
    const TemporaryFolder folder;
    writeAtomically(folder / "a.png", [&](const fs::path& temporary) {
        EXPECT_EQ(temporary.extension(), ".png");
        EXPECT_EQ(temporary.parent_path(), folder.path());
        writeFile(temporary, "x");
    });
}

TEST(FileTest, link_and_permissions_survive_a_write) {
    const TemporaryFolder folder;
    writeFile(folder / "real", "old");
    fs::permissions(folder / "real", fs::perms::owner_read | fs::perms::owner_write);
    fs::create_symlink(folder / "real", folder / "link");
    writeFile(folder / "link", "new");
    EXPECT_TRUE(fs::is_symlink(folder / "link"));
    EXPECT_EQ(readFile(folder / "real"), "new");
    EXPECT_EQ(fs::status(folder / "real").permissions(), fs::perms::owner_read | fs::perms::owner_write);
}

TEST(FileTest, devices_are_written_and_not_replaced) {
    writeFile("/dev/null", "x");
    EXPECT_TRUE(fs::is_character_file("/dev/null"));
}

TEST(FileTest, writability_check_leaves_no_trace) {
    const TemporaryFolder folder;
    requireWritable(folder / "a.png");
    EXPECT_EQ(filesIn(folder.path()), 0U);
}

TEST(ResourcesTest, files_are_found_by_path_and_by_folder) {
    ASSERT_FALSE(resources().empty());
    const Resource& first = resources().front();
    EXPECT_EQ(findResource(first.path)->text, first.text);
    EXPECT_FALSE(findResource("no/such.glsl").has_value());

    const std::vector<Resource> found = resourcesInFolder("tonemappers");
    ASSERT_FALSE(found.empty());
    for (const Resource& resource : found)
        EXPECT_THAT(std::string(resource.path), HasSubstr("/tonemappers/"));
    EXPECT_TRUE(resourcesInFolder("onemappers").empty()) << "a folder's name must match as a whole";
}

} // namespace
} // namespace apeiron
