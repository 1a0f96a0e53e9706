#pragma once
// One line of a stroke log: text to command and back (format in sculpt/README.md).

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include "sculpt/command.h"
#include "sculpt/json_reader.h"

namespace restroke::sculpt {

/// What a stroke line may leave out: the camera and the brush of the nearest stroke line above. Starts empty
/// at the header.
struct LineContext {
  std::optional<Camera> camera = {};
  std::optional<Brush> brush = {};
  std::filesystem::path folder = {};  ///< of the log: files of meshes are named as seen from there
};

/// The lines without the newline at their end. Floats are written with the fewest digits that read back as
/// the same float32.
[[nodiscard]] std::string formatHeader(const LogHeader& header, const std::filesystem::path& folder = {});
[[nodiscard]] std::string formatCommand(const Command& command, LineContext& context);

/// Throw InputError "FILE:LINE: ..." for whatever breaks a rule of the format.
[[nodiscard]] LogHeader parseHeader(std::string_view line, const TextOrigin& origin,
                                    const std::filesystem::path& folder = {});
[[nodiscard]] Command parseCommand(std::string_view line, const TextOrigin& origin, LineContext& context);

/// The fewest digits that read back as the same float32, sign of zero included. `value` is finite.
[[nodiscard]] std::string formatFloat(float value);

}  // namespace restroke::sculpt
