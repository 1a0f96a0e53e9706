#pragma once
// Files that are there whole or not at all.

#include <filesystem>
#include <string>
#include <string_view>

namespace restroke {

/// Writes a file beside its final name and gives it that name once it is complete: whoever looks at the final
/// name sees the former file or the new one, never a part. If anything goes wrong, the former file stays as
/// it was and nothing is left behind.
///
///     AtomicFile file(path);
///     writeSomethingTo(file.temporary());
///     file.commit();
class AtomicFile {
 public:
  /// Makes the empty temporary file `<path>.tmp-<process>-<n>`, so that a folder that is missing or cannot be
  /// written is found before any work is done. Throws InputError that names the file and the system's reason.
  explicit AtomicFile(std::filesystem::path path);
  /// Removes the temporary file, unless it was committed.
  ~AtomicFile();
  AtomicFile(const AtomicFile&) = delete;
  AtomicFile& operator=(const AtomicFile&) = delete;

  /// Where to write: a file in the same folder, so that renaming is atomic.
  [[nodiscard]] const std::filesystem::path& temporary() const { return temporary_; }
  /// The final name.
  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

  /// Replaces what the temporary file holds. Throws InputError (full disk, file too large, ...).
  void write(std::string_view bytes);

  /// Flushes the temporary file to disk and renames it. At most once. Throws InputError; the temporary file
  /// is then removed and the former file, if any, still there.
  void commit();

 private:
  std::filesystem::path path_;
  std::filesystem::path temporary_;
  bool done_ = false;
};

/// The whole of it for contents in memory. Throws InputError that names the file and the system's reason.
void writeFileAtomically(const std::filesystem::path& path, std::string_view bytes);

}  // namespace restroke
