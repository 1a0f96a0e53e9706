// restroke export: the shape for other programs, here as points with normals.

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "implicit/errors.h"
#include "points/files/point_files.h"
#include "sculpt/cli/commands.h"
#include "sculpt/cli/replaying.h"

namespace restroke::cli {

namespace {

std::string extensionOf(const std::string& file) {
  std::string extension = std::filesystem::path(file).extension().string();
  for (char& c : extension)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  return extension;
}

}  // namespace

int runExport(const ExportOptions& options) {
  const std::string extension = extensionOf(options.out);
  for (const char* mesh : {".stl", ".obj", ".amf", ".3mf"})
    if (extension == mesh)
      throw InputError(fmt::format(
          "{}: {} holds a mesh, which this version does not make yet, but the file must end in .ply or .xyz "
          "(points with normals)",
          options.out, extension));
  if (extension != ".ply" && extension != ".xyz")
    throw InputError(fmt::format("{}: ends in \"{}\", but must end in .ply or .xyz", options.out, extension));

  const Execution execution = executionOf(options.common);
  sculpt::StrokeLog log = readLogNoting(options.log);
  overrideDensity(log, options.density);
  Output output(options.common);
  const sculpt::Document document = replayNoting(log, {.file = options.log}, execution);
  const std::vector<points::Surfel> surfels = document.model().surfels(execution);
  if (extension == ".xyz") {
    points::writeXyz(options.out, surfels);
  } else {
    points::writePly(
        options.out, surfels,
        {.format = options.ascii ? points::PlyFormat::Ascii : points::PlyFormat::BinaryLittleEndian,
         .comments = {"Restroke surfels, unit " + log.header.unit}});
  }
  output.say(fmt::format("{}: {} points with normals\n", options.out, grouped(surfels.size())));
  output.finish({{"out", options.out}, {"surfels", surfels.size()}});
  return 0;
}

}  // namespace restroke::cli
