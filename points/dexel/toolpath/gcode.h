#pragma once
// Programs of milling machines, RS-274 ("G-code"), as elements of a tool's path (SPEC R8).
//
// What is understood: the language of T. Kramer, F. Proctor, E. Messina, The NIST RS274NGC Interpreter,
// version 3 (NISTIR 6556, 2000), as far as it moves a tool of three axes:
//
//   G0 G1 G2 G3           rapid and feed moves; arcs and helices by I, J, K (from where the arc begins to its
//                         centre) or R (less than 0: the way of more than half a turn)
//   G17 G18 G19           planes of arcs: XY, XZ, YZ
//   G20 G21               inches, millimetres: a path is in millimetres, and begins with them
//   G90 G91               positions, or steps from the place before
//   T                     the tool in hand from this block on, wherever in the block it stands, until the
//   next M2 M30, a second %    the end: what follows is not read G80                   no motion, until the
//   next word of one
//
// A block without a word of motion repeats the last motion with its own X, Y, Z (of arcs also I, J, K, R).
// Words are capital or small; blanks between and within words count for nothing, ( ) and ; begin comments,
// N numbers lines. Blocks that begin with / are left out ("block delete" is on).
//
// What moves nothing is passed over: F, S, D, H, L, P, Q; M words but for M98 and M99; G4 (with P), G40, G43
// (positions are those of the tool's tip, whatever its length), G49, G54 (the one coordinate system), G61,
// G61.1, G64, G91.1 (centres of arcs are relative), G93 to G99.
//
// Everything else would move the tool, move coordinates, or is not known: an error, which names the line.
//
// Where the tool is before it is sent anywhere: X0 Y0 Z0. Rapid moves up to the first that has a Z, as long
// as there was no feed move, are those that bring it from where it was parked; nobody knows the way, and it
// takes nothing away on it: where the last of them ends the path begins, with an element that stays there.
// Later rapid moves are moves like others: what is in their way is cut.

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string_view>
#include <vector>

#include "points/dexel/toolpath/cutter.h"

namespace restroke::points {

/// The ends of an arc may be at distances from its centre that differ by so much, the greater one: of the
/// radius, or in millimetres. Half the way between the ends may be longer than R by as much.
inline constexpr double kArcTolerance = 0.005, kArcToleranceMillimetres = 0.01;

struct GcodeElement {
  PathElement element;     ///< millimetres
  std::uint32_t tool = 0;  ///< number of the T word
  std::size_t line = 0;    ///< of the file, from 1
  bool isRapid = false;
  bool operator==(const GcodeElement&) const = default;
};

struct GcodeProgram {
  std::vector<GcodeElement> elements;
  /// Moves that left the tool where it was, and those that brought it (above): they are no elements.
  std::size_t still = 0, approaches = 0;
};

struct GcodeOptions {
  /// In hand when the program begins; without, a move before the first T is an error.
  std::optional<std::uint32_t> tool = std::nullopt;
};

/// Throws InputError, "<file>: line <n>: <what was found; which rule it breaks>". A program without moves has
/// no elements. O(file size).
[[nodiscard]] GcodeProgram readGcode(const std::filesystem::path& path, const GcodeOptions& options = {});
/// The same for a file's contents; `name` is what sentences call it.
[[nodiscard]] GcodeProgram parseGcode(std::string_view contents, const std::filesystem::path& name,
                                      const GcodeOptions& options = {});

}  // namespace restroke::points
