// One table: the same list of stamps through Restroke and its rivals, in one run, and a second one: what
// Restroke is to reach, and whether it does. README.md beside this file says how to read them.
//
//   bench_rivals [LOG|STAMPS] [--smoke] [--json FILE] [--csv FILE]
//
// Exit 1 when a rival does not do the same work.

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <span>
#include <string_view>

#include "implicit/errors.h"
#include "implicit/simd/dispatch.h"
#include "tests/bench/machine.h"
#include "tests/bench/rivals_output.h"
#include "tests/bench/stamp_source.h"

namespace restroke::bench {
namespace {

struct Arguments {
  std::filesystem::path list, json, csv;
  bool smoke = false;
};

Arguments parse(std::span<char* const> words) {
  Arguments out;
  for (std::size_t i = 0; i < words.size(); ++i) {
    const std::string_view word = words[i];
    if (word == "--smoke") {
      out.smoke = true;
    } else if (word == "--json" || word == "--csv") {
      if (i + 1 == words.size()) throw InputError(fmt::format("{} needs a file", word));
      (word == "--json" ? out.json : out.csv) = words[++i];
    } else if (word.starts_with("-") || !out.list.empty()) {
      throw InputError(fmt::format(
          "unknown argument '{}'; usage: bench_rivals [LOG|STAMPS] [--smoke] [--json FILE] [--csv FILE]",
          word));
    } else {
      out.list = word;
    }
  }
  return out;
}

Task taskOf(const Arguments& arguments) {
  StampSource source = loadStamps(arguments.list);
  for (const implicit::Primitive& p : source.primitives)
    if (!p.shape.isSphere())
      throw InputError(
          fmt::format("{}: holds a primitive that is no sphere; the rivals stamp spheres only", source.name));
  if (source.primitives.size() < 2)
    throw InputError(fmt::format("{}: holds {} primitives; a base and a stamp are needed", source.name,
                                 source.primitives.size()));
  if (arguments.smoke) source.primitives.resize(std::min<std::size_t>(source.primitives.size(), 60));
  Task task = makeTask(source.name, std::move(source.primitives), source.strokes);
  task.shortened = arguments.smoke ? 3 : 20;
  if (arguments.smoke) task.density = 2000;
  return task;
}

struct Measured {
  RivalsTable table;
  OpenVdbResult csg;
  CorefinementResult corefined;
};

// One after the other in each round, so that what else the machine does falls on all of them.
Measured measure(const Task& task, std::size_t rounds, double corefinementSeconds) {
  Measured out;
  const std::vector<implicit::SimdLevel> levels = implicit::supportedSimdLevels();
  implicit::useSimdLevel(levels.back());
  std::vector<Column> brush, plain;
  Column csg("OpenVDB CSG"), plainBrush("leaf brush, plain"), corefined("CGAL"), embree("Embree, rebuilt"),
      updated("Embree, updated");
  for (const implicit::SimdLevel level : levels) {
    const std::string name(implicit::nameOf(level));
    out.table.ours.emplace_back("Restroke", name);
    brush.emplace_back("leaf brush", name);
    plain.emplace_back("plain list", name);
  }
  out.table.ours.back().add(Row::FirstReplay, 1e3 * replaySeconds(task));
  for (std::size_t round = 0; round < rounds; ++round) {
    for (std::size_t k = 0; k < levels.size(); ++k) {
      implicit::useSimdLevel(levels[k]);
      measureRestroke(task, out.table.ours[k]);
      measureLeafBrush(task, round, brush[k]);
      measurePlainList(task, round, plain[k]);
      if (round == 0) measureBytes(task, out.table.ours[k]);
    }
    measureLeafBrush(task, round, plainBrush);
    measureEmbree(task, out.table.ours.back().at(Row::Rays).value_or(0), embree);
    measureUpdatedEmbree(task, round, updated);
    if (round % 3 == 0) out.csg = measureOpenVdbCsg(task, csg);
  }
  out.corefined = measureCorefinement(task, corefinementSeconds, corefined);
  std::vector<Column>& rivals = out.table.rivals;
  rivals.push_back(std::move(csg));
  rivals.push_back(std::move(plainBrush));
  std::move(brush.begin(), brush.end(), std::back_inserter(rivals));
  std::move(plain.begin(), plain.end(), std::back_inserter(rivals));
  rivals.push_back(std::move(corefined));
  rivals.push_back(std::move(embree));
  rivals.push_back(std::move(updated));
  return out;
}

int run(std::span<char* const> words) {
  const Arguments arguments = parse(words);
  const Task task = taskOf(arguments);
  const std::size_t rounds = arguments.smoke ? 1 : 5;
  const Measured measured = measure(task, rounds, arguments.smoke ? 5 : 20);
  const std::vector<Check> checks = checkRivals(task, measured.table, measured.csg, measured.corefined);
  const Heading heading{.origin = experiments::provenance(),
                        .list = task.name,
                        .primitives = task.list.size(),
                        .strokes = task.strokes.size(),
                        .surfels = modelOf(task).surfelCount(),
                        .activeVoxels = measured.csg.activeVoxels,
                        .rays = task.rays.size(),
                        .rounds = rounds,
                        .shortened = measured.corefined.stamps,
                        .density = task.density,
                        .voxel = task.voxel};
  fmt::print("{}\n{}\n", textOf(heading, measured.table), textOfTargets(measured.table));
  bool hold = true;
  for (const Check& check : checks) {
    fmt::print("{}: {}\n", check.holds ? "holds" : "DOES NOT HOLD", check.sentence);
    hold = hold && check.holds;
  }
  if (!arguments.json.empty())
    writeFile(arguments.json, jsonOf(heading, measured.table, checks).dump(1) + "\n");
  if (!arguments.csv.empty()) writeFile(arguments.csv, csvOf(measured.table));
  return hold ? 0 : 1;
}

}  // namespace
}  // namespace restroke::bench

int main(int argc, char** argv) {
  try {
    return restroke::bench::run(std::span(argv + 1, static_cast<std::size_t>(argc - 1)));
  } catch (const restroke::InputError& error) {
    fmt::print(stderr, "bench_rivals: {}\n", error.what());
    return 2;
  }
}
