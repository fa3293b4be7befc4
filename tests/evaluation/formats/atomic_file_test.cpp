#include "evaluation/formats/atomic_file.hpp"

#include "tests/support/file_test.hpp"

namespace conelane {
namespace {

namespace fs = std::filesystem;

class AtomicFileTest : public FileTest {};

TEST_F(AtomicFileTest, ReplacesTheOldFileOnlyOnCommit) {
    const fs::path file = file_with("old");
    {
        AtomicFile output(file);
        output.stream() << "new";
        EXPECT_EQ(text_of(file), "old");
    }
    EXPECT_EQ(text_of(file), "old") << "destroyed without commit";
    EXPECT_EQ(files_in_folder(), 1u) << "the temporary file is left";
    AtomicFile output(file);
    output.stream() << "new";
    output.commit();
    EXPECT_EQ(text_of(file), "new");
    EXPECT_EQ(files_in_folder(), 1u);
}

TEST_F(AtomicFileTest, TwoWritersDoNotMix) {
    AtomicFile first(path("f"));
    AtomicFile second(path("f"));
    first.stream() << "first";
    second.stream() << "second";
    second.commit();
    first.commit();
    EXPECT_EQ(text_of(path("f")), "first");
    EXPECT_EQ(files_in_folder(), 1u);
}

TEST_F(AtomicFileTest, FollowsSymbolicLinksAndKeepsPermissions) {
    const fs::path file = file_with("old");
    fs::permissions(file, fs::perms::owner_read | fs::perms::owner_write);
    fs::create_symlink(file, path("link"));
    AtomicFile output(path("link"));
    output.stream() << "new";
    output.commit();
    EXPECT_TRUE(fs::is_symlink(path("link")));
    EXPECT_EQ(text_of(file), "new");
    EXPECT_EQ(fs::status(file).permissions(), fs::perms::owner_read | fs::perms::owner_write);
}

TEST_F(AtomicFileTest, NamesTargetsThatCannotBeWritten) {
    EXPECT_EQ(error_of([&] { AtomicFile output(path("absent/f")); }),
              "absent/f: cannot be written: No such file or directory; make the folder '" +
                  path("absent").string() + "' first");
    fs::create_directory(path("folder"));
    EXPECT_EQ(error_of([&] { AtomicFile output(path("folder")); }), "folder: is a folder, not a file");
    EXPECT_EQ(error_of([&] { AtomicFile output(path("new/")); }), "new/: cannot be written: Is a directory");
}

TEST_F(AtomicFileTest, WritesDevicesDirectlyAndReportsAFullOne) {
    AtomicFile null("/dev/null");
    null.stream() << "gone";
    null.commit();
    EXPECT_TRUE(fs::is_character_file("/dev/null"));
    if (!fs::exists("/dev/full")) GTEST_SKIP() << "no /dev/full on this system";
    EXPECT_EQ(error_of([] {
                  AtomicFile full("/dev/full");
                  full.stream() << std::string(100'000, 'x');
                  full.commit();
              }),
              "/dev/full: cannot be written to its end: No space left on device");
}

}  // namespace
}  // namespace conelane
