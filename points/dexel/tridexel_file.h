#pragma once
// Tri-dexel models in files that can be refined later by someone else (SPEC R10): `.tridexel`.
//
// The format, versions 1 and 2: a file has the lowest version that can hold its model. What is marked with
// [2] is there in version 2 only. Numbers are little-endian; f32 and f64 are IEEE 754, u8 to u64 unsigned,
// i32 two's complement. A file is a header of 40 bytes and one zstd frame:
//
//      0  8 x u8  "TRIDEXEL"
//      8  u32     version: 1 or 2
//     12  u32     0
//     16  u64     bytes of the body, unpacked
//     24  u64     bytes of the frame: the file ends with it
//     32  u64     XXH3 (64 bits, no seed) of bytes 0 to 31 and of the frame, one after the other
//     40          the frame; it unpacks to the body
//
// The body, each part right after the other:
//
//     grid        f64 x 3 anchor, f64 cell, i32 x 3 first, i32 x 3 counts (DexelGrid::Parts)
//     volumes     u32 count; each: u8 length and the letters of its kind (implicit/volume_kinds.h); u8 number
//                 of parameters, and of each u32 count and so many f32; u8 1 if it has a mesh, else 0; then
//                 the mesh, u32 length and the letters of its file's name, u64 the file's hash, u8 1 if it
//                 was repaired, else 0
//     initial     u8: 0 nothing; 1 a mesh, which follows; 2 primitives: u32 count, and of each u8 (0 added,
//                 1 carved) and a shape
//     tools       u32 count; so many meshes
//     cutters     [2] u32 count; each: u8 (0 flat, 1 ball, 2 bull nose), f64 radius, f64 length, f64 corner
//                 radius (of a bull nose, else 0), f64 x 9 orientation, row by row (Cutter)
//     operations  u32 count; each: u8 (0 union, 1 subtraction, 2 intersection), then a shape; or u8 2, u32
//                 number of a tool and f64 x 16 its pose, row by row; or [2] u8 3, u32 number of a cutter and
//                 an element of its path: u8 (0 line, 1 arc), f64 x 3 from, f64 x 3 to, f64 x 3 centre, u8
//                 axis (0 to 2), u8 1 if clockwise, else 0 (PathElement; of a line the last three mean
//                 nothing)
//     runs        [2] u32 count; each: u32 first operation (from 1), u32 number of operations, 2 or more;
//                 ascending and apart from each other (TriDexelDocument::Run)
//     lines       of the families along x, y and z, one after the other: u8 1 if ends have operations, else
//                 0, and [2] 2 more if histories are kept (of all families or none); u64 number of ends;
//                 their columns; [2] and with histories u64 number of entries; their columns
//
//     a mesh      u32 vertices, u32 triangles; f32 x 3 of each vertex, u32 x 3 of each triangle
//     a shape     u8 0: a ball, f32 x 3 centre, f32 radius; or u8 1: u32 number of a volume, f32 x 3
//                 position, f32 x 4 rotation, f32 scale (implicit::Pose)
//
// A column of n words holds the lowest byte of all words, then the second of all, and so on: 4 n bytes. The
// columns of a family are
//
//     the number of ends of each line, by rows
//     of all ends, line by line: depth; normal's lower 15 bits; its next 15 bits; its upper 2 bits (the lower
//     one of them unused, the upper one: cut); and with operations inner and outer + 1 (0: none)
//
// [2] The columns of its histories are
//
//     the number of operations that changed each line, by rows
//     of all lines, line by line, those operations (from 1), ascending; of a run only the first may be named
//
// A word is the difference between the number and what was expected, d = number - expected modulo 2^32,
// folded: 2 d for d < 2^31, else 2 (2^32 - d) - 1. Depths are made whole numbers in their order: the bits of
// the float with the sign bit flipped for positive numbers, all bits flipped for negative ones. The number of
// ends, or of operations that changed a line, is expected to be the one of the line before in the row (0 for
// the first). An operation that changed a line is expected to be the one before it on the line, else 0. For
// end k of a line, of the
// line before it in the row (L), of the line above (A) and of the one before that (B), those that have as
// many ends as this line are looked at: expected is L + A - B (modulo 2^32) of their ends k where there are
// all three, else L, else A, else the number of the end before it on the line, else 0.

#include <filesystem>
#include <string>
#include <string_view>

#include "points/dexel/dexel_document.h"

namespace restroke::points {

/// Writes the file beside its final name and renames it. Throws InputError that names the file when it cannot
/// be written, or the document holds what the format cannot: a tool, cutter, vertex, operation or run that is
/// not there, numbers that are not finite. O(lines + ends + histories + meshes) time and memory.
void writeTriDexel(const std::filesystem::path& path, const TriDexelDocument& document);

/// Reads a file: the document bit for bit; what shapes shared they share again. Throws InputError, one
/// sentence with the file, the byte and the rule, for anything that is not a whole, unchanged file of these
/// versions that keeps every rule; memory is taken only after it was found that the file fills it.
[[nodiscard]] TriDexelDocument readTriDexel(const std::filesystem::path& path);

/// The same for a file's contents; `name` is what sentences call it.
[[nodiscard]] std::string formatTriDexel(const TriDexelDocument& document, const std::filesystem::path& name);
[[nodiscard]] TriDexelDocument parseTriDexel(std::string_view contents, const std::filesystem::path& name);

}  // namespace restroke::points
