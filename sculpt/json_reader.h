#pragma once
// Strict reading of JSON that people and other programs wrote: nothing is guessed, nothing is ignored
// silently.

#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>

namespace restroke::sculpt {

/// Deepest nesting of arrays and objects that is read. Our formats need 6.
inline constexpr std::size_t kMaxJsonDepth = 32;

/// Where a text comes from, for messages.
struct TextOrigin {
  std::string file;      ///< as the user wrote it
  std::size_t line = 1;  ///< line of the file on which the text begins
};

/// Parses one JSON value that takes up the whole text. Throws InputError "FILE:LINE: ..." for anything that
/// is not JSON, a key that occurs twice in one object, a number that overflows, or nesting deeper than
/// kMaxJsonDepth. O(text).
[[nodiscard]] nlohmann::json parseJson(std::string_view text, const TextOrigin& origin);

/// A value short enough for a message: numbers and strings as they are (cut at 40 characters), "an array of
/// 3", "an object".
[[nodiscard]] std::string describe(const nlohmann::json& value);

/// A range that both ends belong to, and the words that name it in a message.
struct NumberRange {
  double min = 0;
  double max = 0;
  const char* rule = "";  ///< for instance "a number from 0 to 1"
};

/// One value of a parsed text, which knows where it stands. Cheap to copy; the JSON must outlive it.
/// Every reading function throws InputError "FILE:LINE: PATH is VALUE, but must be RULE".
class JsonField {
 public:
  JsonField(const nlohmann::json& value, std::string where, std::string path = {});

  [[nodiscard]] const nlohmann::json& value() const { return *value_; }
  [[nodiscard]] const std::string& where() const { return where_; }
  [[nodiscard]] const std::string& path() const { return path_; }

  /// Refuses anything but an object with keys out of these.
  void requireKeysAmong(std::initializer_list<const char*> keys) const;
  [[nodiscard]] bool has(const char* key) const;
  /// The member; throws when this is not an object or lacks it.
  [[nodiscard]] JsonField member(const char* key) const;
  /// Number of elements; throws when this is not an array.
  [[nodiscard]] std::size_t arraySize() const;
  [[nodiscard]] JsonField element(std::size_t index) const;

  /// A finite number in the range.
  [[nodiscard]] double number(const NumberRange& range) const;
  /// The same, rounded to float32, which must be in the range too.
  [[nodiscard]] float number32(const NumberRange& range) const;
  /// A number written without fraction or exponent, in the range.
  [[nodiscard]] std::int64_t integer(const NumberRange& range) const;
  [[nodiscard]] std::string string() const;

  /// Throws the InputError that says what this is and what it must be.
  [[noreturn]] void refuse(std::string_view rule) const;

 private:
  const nlohmann::json* value_;
  std::string where_;
  std::string path_;
};

}  // namespace restroke::sculpt
