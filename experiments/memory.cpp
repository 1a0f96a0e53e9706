#include "experiments/memory.h"

#include <algorithm>
#include <variant>

#include "experiments/paper_table.h"
#include "experiments/pictures.h"
#include "experiments/provenance.h"
#include "experiments/random.h"
#include "experiments/text.h"
#include "implicit/errors.h"
#include "sculpt/document.h"
#include "sculpt/stroke_log.h"

namespace restroke::experiments {
namespace {

// Fewer samples than this and a dab has hardly any: enough to run every path, too few to measure.
constexpr float kSmokeDensity = 400;

std::vector<implicit::Primitive> primitivesOf(const implicit::PrimitiveList& list) {
  std::vector<implicit::Primitive> all;
  all.reserve(list.size());
  for (std::size_t i = 0; i < list.size(); ++i) all.push_back(list.at(i));
  return all;
}

std::string nameOf(const sculpt::Command& command) {
  if (std::holds_alternative<sculpt::StrokeCommand>(command)) return "stroke";
  if (std::holds_alternative<sculpt::FixedCommand>(command)) return "fixed";
  if (std::holds_alternative<sculpt::UndoCommand>(command)) return "undo";
  if (std::holds_alternative<sculpt::RedoCommand>(command)) return "redo";
  throw InputError(
      "the log edits its tree or changes its base, but the back ends are compared on strokes, fixed stamps, "
      "undo "
      "and redo, which all of them can do");
}

/// All back ends, fed with one log, and the reference that they are compared with.
class Run {
 public:
  Run(const sculpt::LogHeader& header, const Execution& execution)
      : execution_(execution), reference_(header, {}, execution) {
    const auto list = primitivesOf(reference_.model().list());
    const auto surfels = reference_.model().surfels(execution);
    const Start start{.header = header, .list = list, .surfels = surfels, .execution = execution};
    for (const BackendKind kind : kAllBackends) backends_.push_back(makeBackend(kind, start));
    note({list, surfels});
  }

  [[nodiscard]] const sculpt::Document& reference() const { return reference_; }
  [[nodiscard]] const std::vector<std::unique_ptr<HistoryBackend>>& backends() const { return backends_; }

  /// Returns the number of stamps that the command added.
  std::size_t apply(const sculpt::Command& command) {
    const sculpt::CommandReport report = reference_.apply(command);
    if (std::holds_alternative<sculpt::UndoCommand>(command)) {
      for (auto& backend : backends_) backend->undo();
      --cursor_;
      return 0;
    }
    if (std::holds_alternative<sculpt::RedoCommand>(command)) {
      for (auto& backend : backends_) backend->redo();
      ++cursor_;
      return 0;
    }
    const auto list = primitivesOf(reference_.model().list());
    const auto surfels = reference_.model().surfels(execution_);
    const Step step{.command = command, .list = list, .surfels = surfels};
    for (auto& backend : backends_) backend->apply(step);
    path_.resize(++cursor_);
    note({list, surfels});
    return report.primitivesAdded;
  }

  /// Walks every back end back and forth along the path and compares each state with the one on the way
  /// there.
  std::size_t walk(int steps, Random random) {
    check();
    std::size_t walked = 0;
    for (int i = 0; i < steps && path_.size() > 1; ++i) {
      const bool back = cursor_ + 1 == path_.size() || (cursor_ > 0 && random.below(2) == 0);
      for (auto& backend : backends_) back ? backend->undo() : backend->redo();
      cursor_ = back ? cursor_ - 1 : cursor_ + 1;
      check();
      ++walked;
    }
    return walked;
  }

 private:
  void check() const {
    for (std::size_t i = 0; i < backends_.size(); ++i)
      if (backends_[i]->stateHash() != path_[cursor_][i])
        throw InternalError(
            fmt::format("memory: {} restored another state than the log's at step {} of the path",
                        backends_[i]->name(), cursor_));
  }
  void note(const ShapeView& shape) {
    path_.emplace_back();
    for (const auto& backend : backends_) path_.back().push_back(backend->hashOfShape(shape));
  }

  Execution execution_;
  sculpt::Document reference_;
  std::vector<std::unique_ptr<HistoryBackend>> backends_;
  /// State hashes of each back end, from the start to the last step that can be redone.
  std::vector<std::vector<std::uint64_t>> path_;
  std::size_t cursor_ = 0;
};

std::vector<MemoryRow> rowsOf(const Run& run) {
  std::vector<MemoryRow> rows;
  for (const auto& backend : run.backends()) {
    MemoryRow row;
    row.backend = backend->name();
    row.title = backend->title();
    row.abilities = backend->abilities();
    row.bytes = backend->bytes();
    row.stateBytes = backend->stateBytes();
    rows.push_back(row);
    if (const auto counted = backend->paperBytes()) {
      row.backend += "-paper";
      row.title += ", the paper's count";
      row.measured = false;
      row.bytes = *counted;
      row.stateBytes = 0;
      rows.push_back(row);
    }
  }
  return rows;
}

/// The paper's own figures as rows, beside those of the same kind.
void addPaperRows(MemoryLog& log) {
  for (MemoryStep& step : log.steps) {
    const PaperStep paper = step.step == 0 ? PaperStep{} : kPaperTable2.at(step.step - 1);
    std::vector<MemoryRow> rows;
    for (const MemoryRow& row : step.rows) {
      rows.push_back(row);
      if (row.measured || (row.backend != "strokes-paper" && row.backend != "list-snapshots-paper")) continue;
      MemoryRow table = row;
      const bool strokes = row.backend == "strokes-paper";
      table.backend = strokes ? "strokes-table2" : "list-snapshots-table2";
      table.title = strokes ? "Strokes, as printed in the paper" : "Snapshots, as printed in the paper";
      table.bytes = strokes ? paper.strokeBytes : paper.snapshotBytes;
      rows.push_back(table);
    }
    step.rows = std::move(rows);
  }
}

std::vector<std::size_t> pictureSteps(std::size_t commands, int pictures) {
  std::vector<std::size_t> steps;
  const auto wanted = static_cast<std::size_t>(std::max(pictures, 0));
  for (std::size_t i = 1; i <= wanted; ++i) {
    const std::size_t step = commands * i / wanted;
    if (steps.empty() || steps.back() != step) steps.push_back(step);
  }
  return steps;
}

/// A shape kept to be drawn once the whole log is known, so that all pictures of a log share a camera.
struct Kept {
  std::size_t step;
  std::vector<points::Surfel> surfels;
  std::vector<std::uint32_t> nodes;
};

}  // namespace

MemoryOptions smokeSize(MemoryOptions options) {
  if (!(options.density > 0)) options.density = kSmokeDensity;
  options.walkSteps = std::min(options.walkSteps, 8);
  options.pictures = std::min(options.pictures, 2);
  options.pictureSize = std::min(options.pictureSize, 160u);
  return options;
}

std::string describe(const MemoryOptions& options) {
  return fmt::format("density={} walkSteps={} seed={} pictures={} pictureSize={}", options.density,
                     options.walkSteps, options.seed, options.pictures, options.pictureSize);
}

void makeNamesUnique(std::vector<MemoryLog>& logs) {
  for (std::size_t i = 0; i < logs.size(); ++i)
    logs[i].name = untakenName(logs[i].name, [&](std::string_view name) {
      return std::any_of(logs.begin(), logs.begin() + static_cast<std::ptrdiff_t>(i),
                         [&](const MemoryLog& log) { return log.name == name; });
    });
}

MemoryLog measureMemory(const std::filesystem::path& file, const MemoryOptions& options,
                        const Execution& execution, const StepProgress& progress) {
  sculpt::StrokeLog source = sculpt::readLog(file);
  if (options.density > 0) source.header.density = options.density;
  MemoryLog log;
  log.name = file.stem().string();
  log.file = file;
  log.hash = hashOfFile(file);
  log.density = source.header.density;

  Run run(source.header, execution);
  log.steps.push_back({.step = 0,
                       .command = "start",
                       .stamps = 0,
                       .primitives = run.reference().model().list().size(),
                       .surfels = run.reference().model().surfelCount(),
                       .rows = rowsOf(run)});
  const std::vector<std::size_t> wanted = pictureSteps(source.commands.size(), options.pictures);
  std::vector<Kept> kept;
  std::vector<std::size_t> stampsPerStroke;
  Box box = run.reference().model().list().bounds();
  for (std::size_t i = 0; i < source.commands.size(); ++i) {
    const sculpt::Command& command = source.commands[i];
    MemoryStep step;
    step.step = i + 1;
    try {
      step.command = nameOf(command);
      step.stamps = run.apply(command);
    } catch (const InputError& error) {
      throw InputError(fmt::format("{}: command {}: {}", file.string(), i + 1, error.what()));
    }
    if (step.command == "stroke" || step.command == "fixed") {
      stampsPerStroke.push_back(step.stamps);
      log.stamps += step.stamps;
    }
    const points::SurfelModel& model = run.reference().model();
    step.primitives = model.list().size();
    step.surfels = model.surfelCount();
    step.rows = rowsOf(run);
    log.steps.push_back(std::move(step));
    if (std::ranges::find(wanted, i + 1) != wanted.end()) {
      box.add(model.list().bounds());
      kept.push_back({i + 1, model.surfels(execution), run.reference().nodeOfPrimitive()});
    }
    if (progress) progress(i + 1, source.commands.size());
  }
  log.strokes = stampsPerStroke.size();
  log.paperTable2 = isPaperTable2(stampsPerStroke) && log.strokes == source.commands.size();
  if (log.paperTable2) addPaperRows(log);

  log.walked = run.walk(options.walkSteps, Random(options.seed));

  PictureBall ball{.center = box.center()};
  for (const Kept& shape : kept) ball.add(shape.surfels);
  const Camera camera = pictureCamera(source, ball, options.pictureSize);
  for (const Kept& shape : kept)
    log.pictures.push_back(
        {shape.step,
         drawPicture({.surfels = shape.surfels, .strokeOfPrimitive = shape.nodes}, camera, execution)});
  return log;
}

}  // namespace restroke::experiments
