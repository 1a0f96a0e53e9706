// Files that are whole or absent: full disk, read-only disk, existing files untouched.

#include <gtest/gtest.h>
#include <sys/mount.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <csignal>
#include <filesystem>
#include <fstream>

#include "implicit/atomic_file.h"
#include "implicit/errors.h"

namespace restroke {
namespace {

namespace fs = std::filesystem;

std::string bytesOf(const fs::path& path) {
  std::ifstream in(path, std::ios::binary);
  return std::string(std::istreambuf_iterator<char>(in), {});
}

std::vector<std::string> namesIn(const fs::path& folder) {
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(folder)) names.push_back(entry.path().filename().string());
  return names;
}

class AtomicFileTest : public ::testing::Test {
 protected:
  void SetUp() override {
    const auto* const info = ::testing::UnitTest::GetInstance()->current_test_info();
    folder_ = fs::path(::testing::TempDir()) / ("restroke_atomic_" + std::string(info->name()));
    fs::remove_all(folder_);
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }
  [[nodiscard]] const fs::path& folder() const { return folder_; }

 private:
  fs::path folder_;
};

/// Expects an InputError that names the file and contains the words.
template <class Action>
void expectRefusal(const fs::path& file, const std::string& words, Action action) {
  try {
    action();
    FAIL() << "nothing was thrown";
  } catch (const InputError& error) {
    const std::string sentence = error.what();
    EXPECT_NE(sentence.find(file.string()), std::string::npos) << sentence;
    EXPECT_NE(sentence.find(words), std::string::npos) << sentence;
    EXPECT_EQ(sentence.find('\n'), std::string::npos) << sentence;
  }
}

TEST_F(AtomicFileTest, WritesAndReplacesWithoutLeavingATemporary) {
  const fs::path file = folder() / "a.bin";
  writeFileAtomically(file, std::string_view("first\0line", 10));
  EXPECT_EQ(bytesOf(file), std::string("first\0line", 10));
  writeFileAtomically(file, std::string_view());
  EXPECT_EQ(bytesOf(file), "");
  writeFileAtomically(file, std::string("second"));
  EXPECT_EQ(bytesOf(file), "second");
  EXPECT_EQ(namesIn(folder()), std::vector<std::string>{"a.bin"});
}

TEST_F(AtomicFileTest, WithoutACommitNothingChanges) {
  const fs::path file = folder() / "a.txt";
  writeFileAtomically(file, std::string_view("old"));
  {
    AtomicFile atomic(file);
    atomic.write("new and unfinished");
    EXPECT_EQ(atomic.temporary().parent_path(), folder());
    EXPECT_EQ(bytesOf(atomic.temporary()), "new and unfinished");
    EXPECT_EQ(bytesOf(file), "old");
  }
  EXPECT_EQ(bytesOf(file), "old");
  EXPECT_EQ(namesIn(folder()), std::vector<std::string>{"a.txt"});
}

TEST_F(AtomicFileTest, TwoWritersOfOneFileDoNotMix) {
  const fs::path file = folder() / "a.txt";
  AtomicFile one(file), two(file);
  EXPECT_NE(one.temporary(), two.temporary());
  one.write("one");
  two.write("two");
  two.commit();
  one.commit();
  EXPECT_EQ(bytesOf(file), "one");
}

TEST_F(AtomicFileTest, KeepsPermissionsAndFollowsLinks) {
  const fs::path file = folder() / "a.txt", link = folder() / "link";
  writeFileAtomically(file, std::string_view("old"));
  fs::permissions(file, fs::perms(0640));
  fs::create_symlink("a.txt", link);
  writeFileAtomically(link, std::string_view("new"));
  EXPECT_TRUE(fs::is_symlink(link));
  EXPECT_EQ(bytesOf(file), "new");
  EXPECT_EQ(fs::status(file).permissions(), fs::perms(0640));
}

TEST_F(AtomicFileTest, MissingFoldersFoldersAndDevicesAreRefused) {
  const fs::path missing = folder() / "absent" / "a.txt";
  expectRefusal(missing, "No such file or directory", [&] { AtomicFile file(missing); });
  expectRefusal(folder(), "Is a directory", [&] { AtomicFile file(folder()); });
  expectRefusal("/dev/full", "not a regular file", [&] { AtomicFile file("/dev/full"); });
  EXPECT_THROW(AtomicFile(""), InputError);
  expectRefusal("/proc/restroke.txt", "cannot write this file",
                [&] { AtomicFile file("/proc/restroke.txt"); });
  EXPECT_TRUE(fs::is_empty(folder()));
}

TEST_F(AtomicFileTest, AFileBeyondTheSizeLimitIsOneSentenceAndLeavesNoFile) {
  const fs::path file = folder() / "big.bin";
  writeFileAtomically(file, std::string_view("old"));
  rlimit former{};
  ASSERT_EQ(getrlimit(RLIMIT_FSIZE, &former), 0);
  const auto formerHandler = std::signal(SIGXFSZ, SIG_IGN);
  const rlimit small{1 << 16, former.rlim_max};
  ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &small), 0);
  expectRefusal(file, "File too large", [&] { writeFileAtomically(file, std::string(1 << 20, 'x')); });
  ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &former), 0);
  std::signal(SIGXFSZ, formerHandler);
  EXPECT_EQ(bytesOf(file), "old");
  EXPECT_EQ(namesIn(folder()), std::vector<std::string>{"big.bin"});
}

/// A file system of its own, in memory, so that it can be full or read-only for root too.
class SmallDisk {
 public:
  explicit SmallDisk(fs::path place) : place_(std::move(place)) {
    fs::create_directories(place_);
    mounted_ = ::mount("restroke", place_.c_str(), "tmpfs", 0, "size=256k") == 0;
  }
  ~SmallDisk() {
    if (mounted_) ::umount(place_.c_str());
  }
  SmallDisk(const SmallDisk&) = delete;
  SmallDisk& operator=(const SmallDisk&) = delete;
  [[nodiscard]] bool isMounted() const { return mounted_; }
  [[nodiscard]] bool makeReadOnly() const {
    return ::mount("restroke", place_.c_str(), "tmpfs", MS_REMOUNT | MS_RDONLY, "size=256k") == 0;
  }

 private:
  fs::path place_;
  bool mounted_ = false;
};

TEST_F(AtomicFileTest, AFullDiskIsOneSentenceAndLeavesTheFormerFile) {
  const fs::path place = folder() / "disk", file = place / "a.bin";
  const SmallDisk disk(place);
  if (!disk.isMounted()) GTEST_SKIP() << "mounting a tmpfs is not allowed here";
  writeFileAtomically(file, std::string_view("old"));
  expectRefusal(file, "No space left on device",
                [&] { writeFileAtomically(file, std::string(1 << 20, 'x')); });
  EXPECT_EQ(bytesOf(file), "old");
  EXPECT_EQ(namesIn(place), std::vector<std::string>{"a.bin"});
}

TEST_F(AtomicFileTest, AReadOnlyDiskIsOneSentenceAndLeavesTheFormerFile) {
  const fs::path place = folder() / "disk", file = place / "a.bin";
  const SmallDisk disk(place);
  if (!disk.isMounted()) GTEST_SKIP() << "mounting a tmpfs is not allowed here";
  writeFileAtomically(file, std::string_view("old"));
  ASSERT_TRUE(disk.makeReadOnly());
  expectRefusal(file, "Read-only file system", [&] { writeFileAtomically(file, std::string_view("new")); });
  EXPECT_EQ(bytesOf(file), "old");
}

TEST_F(AtomicFileTest, AFolderWithoutWritePermissionIsRefused) {
  if (::geteuid() == 0) GTEST_SKIP() << "permissions do not bind root";
  const fs::path place = folder() / "closed";
  fs::create_directories(place);
  fs::permissions(place, fs::perms(0555));
  expectRefusal(place / "a.txt", "Permission denied", [&] { AtomicFile file(place / "a.txt"); });
  fs::permissions(place, fs::perms(0755));
}

}  // namespace
}  // namespace restroke
