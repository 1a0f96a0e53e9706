#include "experiments/retarget.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <mutex>
#include <set>

#include "experiments/provenance.h"
#include "experiments/retarget/drawing.h"
#include "experiments/retarget/edits.h"
#include "experiments/retarget/pictures.h"
#include "experiments/retarget/summary.h"
#include "experiments/retarget/trials.h"
#include "experiments/shipped.h"
#include "experiments/text.h"
#include "implicit/errors.h"
#include "implicit/parallel.h"
#include "sculpt/pen_strokes.h"

namespace restroke::experiments {
namespace {

namespace fs = std::filesystem;
using retarget::Method;

// A changed base has so many times the surfels, so that no sample is where it was.
constexpr double kOtherDensity = 1.37;

// Samples per square unit of the sphere that pen strokes become a log on.
constexpr float kEditDensity = 600, kSmokeDensity = 400;
// Of the lump, model units: some 5,000 triangles; some 500.
constexpr double kLumpEdge = 0.06, kSmokeLumpEdge = 0.2;

/// One change of one base; of `patch`, for one stroke.
struct Job {
  ChangeKind kind;
  double strength;
  std::optional<std::size_t> stroke;
};

std::vector<Job> jobsFor(const Drawing& drawing, const RetargetOptions& options) {
  std::vector<Job> jobs;
  for (const ChangeInfo& info : changeKinds())
    for (const double strength : options.smoke ? info.smokeStrengths : info.strengths) {
      if (info.kind != ChangeKind::Patch) {
        jobs.push_back({info.kind, strength, std::nullopt});
        continue;
      }
      for (const std::size_t i : thinned(drawing.strokes.size(), options.patchStrokes))
        jobs.push_back({info.kind, strength, i});
    }
  return jobs;
}

/// What a job needs, made once.
struct Prepared {
  std::unique_ptr<KnownChange> change;  // null: the image is no solid
  std::string refusal;                  // why
  std::unique_ptr<const points::SurfelModel> model;
  std::unique_ptr<const retarget::SurfaceDistance> surface;
  FoundMotion motion;
  [[nodiscard]] ChangedBase base() const { return {change.get(), model.get(), surface.get(), &motion}; }
};

/// The hit that is nearest to the mean of all hits: where bulges are set.
void setMiddle(const Drawing& drawing, ChangeSite& site) {
  DVec3 mean(0);
  double count = 0;
  for (const DrawnStroke& stroke : drawing.strokes)
    for (const Point& p : stroke.hits()) mean += DVec3(p), ++count;
  mean /= count;
  double least = 1e300;
  for (const DrawnStroke& stroke : drawing.strokes)
    for (const retarget::TrailPoint& p : stroke.trail.points)
      if (p.hit && length(DVec3(p.hit->position) - mean) < least) {
        least = length(DVec3(p.hit->position) - mean);
        site.middle = DVec3(p.hit->position);
        site.outward = DVec3(p.hit->normal);
      }
}

Prepared prepared(const Drawing& drawing, const Job& job, const RetargetOptions& options) {
  ChangeSite site{.base = drawing.base};
  site.seed = options.seed * 1'000'003 + static_cast<std::uint64_t>(job.kind) * 1009 +
              static_cast<std::uint64_t>(std::llround(job.strength * 1000)) * 7 + job.stroke.value_or(0);
  setMiddle(drawing, site);
  std::vector<Point> kept;
  if (job.stroke) kept = drawing.strokes[*job.stroke].hits();
  site.kept = kept;
  Prepared result;
  try {
    result.change = std::make_unique<KnownChange>(
        makeChange(job.kind, job.strength, site, {.mostTriangles = options.triangles, .edge = options.edge}));
  } catch (const InputError& error) {
    result.refusal = error.what();
    return result;
  }
  result.model = modelOf(result.change->image, kOtherDensity * static_cast<double>(options.samples), {});
  result.surface = std::make_unique<retarget::SurfaceDistance>(*result.model);
  retarget::AlignmentOptions alignment{.points = options.alignmentPoints, .seed = options.seed};
  if (job.stroke) {
    alignment.mode = retarget::AlignmentMode::Patch;
    result.motion = alignedPatch(*drawing.model, *result.model,
                                 {drawing.strokes[*job.stroke], result.change->patchRadius}, alignment);
  } else {
    result.motion = alignedWhole(*drawing.model, *result.model, alignment);
  }
  return result;
}

std::vector<RetargetTrial> tried(const Drawing& drawing, const Job& job, const ChangedBase& base,
                                 Method method) {
  std::vector<RetargetTrial> trials;
  Follower follower(base, method, {});
  for (std::size_t i = 0; i < drawing.strokes.size(); ++i) {
    if (job.stroke && *job.stroke != i) continue;
    const DrawnStroke& stroke = drawing.strokes[i];
    RetargetTrial trial = measured(stroke, base, follower.follow(stroke), drawing.subject.size);
    trial.stroke = i;
    trial.source = stroke.source;
    trial.method = method;
    trial.fellBack = follower.fellBack();
    trials.push_back(std::move(trial));
  }
  return trials;
}

/// What one job gave.
struct JobResult {
  RetargetCase changeCase;
  std::vector<RetargetTrial> trials;
  std::string note;  // why it was left out
};

JobResult measuredJob(const Drawing& drawing, const Job& job, std::span<const Method> methods,
                      const RetargetOptions& options) {
  const Prepared each = prepared(drawing, job, options);
  JobResult result;
  if (!each.change) {
    result.note = fmt::format("{}, {} {:g}: left out: {}", drawing.subject.name, infoOf(job.kind).name,
                              job.strength, each.refusal);
    return result;
  }
  for (const Method method : methods) {
    auto more = tried(drawing, job, each.base(), method);
    result.trials.insert(result.trials.end(), std::make_move_iterator(more.begin()),
                         std::make_move_iterator(more.end()));
  }
  result.changeCase = {.kind = job.kind,
                       .strength = job.strength,
                       .exactImage = each.change->exactImage,
                       .chordError = each.change->chordError / drawing.subject.size,
                       .verdict = each.motion.verdict};
  return result;
}

/// All trials of one base. Jobs run side by side; their results are put together in their order.
void measureSubject(const Drawing& drawing, const RetargetOptions& options, const Execution& execution,
                    const RetargetProgress& progress, RetargetResults& results) {
  const std::vector<Job> jobs = jobsFor(drawing, options);
  std::vector<JobResult> done(jobs.size());
  std::mutex counting;
  std::size_t count = 0;
  inArena(execution, [&] {
    tbb::parallel_for(std::size_t{0}, jobs.size(), [&](std::size_t i) {
      done[i] = measuredJob(drawing, jobs[i], results.methods, options);
      const std::scoped_lock lock(counting);
      if (progress) progress(drawing.subject.name, ++count, jobs.size());
    });
  });
  const std::size_t subject = results.subjects.size();
  results.subjects.push_back(drawing.subject);
  for (JobResult& each : done) {
    if (!each.note.empty()) {
      results.notes.push_back(std::move(each.note));
      continue;
    }
    for (RetargetTrial& trial : each.trials) {
      trial.changeCase = results.cases.size();
      results.trials.push_back(std::move(trial));
    }
    each.changeCase.subject = subject;
    results.cases.push_back(std::move(each.changeCase));
  }
}

/// Makes a change again, to draw it; nothing where it was left out.
std::optional<RetargetPictures> picturesOfChange(const Drawing& drawing, ChangeKind kind, double strength,
                                                 const RetargetOptions& options, const Execution& execution) {
  for (const Job& job : jobsFor(drawing, options)) {
    if (job.kind != kind || job.strength != strength) continue;
    const Prepared each = prepared(drawing, job, options);
    if (!each.change) continue;
    return RetargetPictures{
        .caption = fmt::format("{}, {} {:g} {}", drawing.subject.name, infoOf(kind).name, strength,
                               infoOf(kind).unit),
        .name = fmt::format("{}-{}-{:g}", drawing.subject.name, infoOf(kind).name, strength),
        .pictures =
            picturesOf(drawing, each.base(), {.size = options.pictureSize, .only = job.stroke}, execution)};
  }
  return std::nullopt;
}

/// Strengths that pictures show: strong enough to see.
constexpr std::array<std::pair<ChangeKind, double>, 6> kPictured{{{ChangeKind::Motion, 0.5},
                                                                  {ChangeKind::Stretch, 1.5},
                                                                  {ChangeKind::Bend, 45},
                                                                  {ChangeKind::Twist, 45},
                                                                  {ChangeKind::Bulge, 0.8},
                                                                  {ChangeKind::Patch, 0.5}}};
constexpr std::array<std::pair<ChangeKind, double>, 2> kSmokePictured{
    {{ChangeKind::Motion, 1}, {ChangeKind::Bulge, 0.2}}};
constexpr std::size_t kWorstShown = 3;

void addPictures(const std::vector<Drawing>& drawings, const RetargetOptions& options,
                 const Execution& execution, RetargetResults& results) {
  const auto add = [&](const Drawing& drawing, ChangeKind kind, double strength) {
    if (auto row = picturesOfChange(drawing, kind, strength, options, execution))
      results.pictures.push_back(std::move(*row));
  };
  // Of those that tell their motion, the bunny where it is there.
  const Drawing* shown = &drawings.back();
  for (const Drawing& drawing : drawings)
    if (drawing.subject.tellsMotion && (!shown->subject.tellsMotion || drawing.subject.name == "bunny"))
      shown = &drawing;
  if (options.smoke)
    for (const auto& [kind, strength] : kSmokePictured) add(*shown, kind, strength);
  else
    for (const auto& [kind, strength] : kPictured) add(*shown, kind, strength);
  results.worseFrom = results.pictures.size();
  for (const WorseCase& worse : whereAlignedIsWorse(results)) {
    if (results.pictures.size() == results.worseFrom + (options.smoke ? 1 : kWorstShown)) break;
    add(drawings[worse.subject], worse.kind, worse.strength);
  }
}

/// Two logs of one name: head, head-2.
void makeNamesUnique(std::vector<Drawing>& drawings) {
  std::set<std::string> taken;
  for (Drawing& drawing : drawings) {
    const std::string stem = drawing.subject.name;
    for (int number = 2; !taken.insert(drawing.subject.name).second; ++number)
      drawing.subject.name = fmt::format("{}-{}", stem, number);
  }
}

void addInput(RetargetResults& results, const fs::path& file) {
  results.inputs.emplace_back(file.filename().string(), hashOfFile(file));
}

}  // namespace

RetargetOptions smokeSize(RetargetOptions options) {
  options.smoke = true;
  options.strokes = std::min<std::size_t>(options.strokes, 3);
  options.samples = std::min<std::size_t>(options.samples, 2000);
  options.alignmentPoints = 600;
  options.edge = 0.06;
  options.patchStrokes = 1;
  options.triangles = std::min<std::size_t>(options.triangles, 3000);
  options.logStrokes = 3;
  options.pictureSize = std::min(options.pictureSize, 160u);
  return options;
}

std::string describe(const RetargetOptions& o) {
  return fmt::format(
      "strokes={} samples={} alignmentPoints={} patchStrokes={} edge={} triangles={} logStrokes={} seed={} "
      "pictureSize={} "
      "openGl={} "
      "smoke={}",
      o.strokes, o.samples, o.alignmentPoints, o.patchStrokes, o.edge, o.triangles, o.logStrokes, o.seed,
      o.pictureSize, o.openGl, o.smoke);
}

RetargetInput defaultInput(std::vector<fs::path> logs) {
  RetargetInput input;
  input.logs = std::move(logs);
  if (!input.logs.empty()) return input;
  input.pens.push_back(shippedFile("examples/pen.json"));
  const char* shared = std::getenv("RESTROKE_SHARED");
  const fs::path data = fs::path(shared != nullptr ? shared : RESTROKE_SHARED_DIR) / "data";
  std::error_code ignored;
  std::set<fs::path> files;
  for (const auto& entry : fs::directory_iterator(data / "strokes", ignored))
    if (entry.path().extension() == ".json") files.insert(entry.path());
  input.pens.insert(input.pens.end(), files.begin(), files.end());
  input.meshes = data / "meshes" / "closed";
  return input;
}

RetargetResults measureRetarget(const RetargetInput& input, const RetargetOptions& options,
                                const Execution& execution, const RetargetProgress& progress) {
  RetargetResults results;
  results.methods = methodsToTry(options, results.notes);
  std::vector<RetargetBase> bases = builtInBases(options.smoke ? kSmokeLumpEdge : kLumpEdge);
  if (options.smoke) {
    std::erase_if(bases, [](const RetargetBase& b) { return b.name == "superellipsoid"; });
  } else if (!input.meshes.empty()) {
    const std::vector<RetargetBase> meshes = meshBases(input.meshes);
    bases.insert(bases.end(), meshes.begin(), meshes.end());
    if (meshes.empty())
      results.notes.emplace_back("the meshes of the shared data are not there: bases made here only");
  }
  std::vector<fs::path> pens = input.pens;
  if (options.smoke && pens.size() > 1) pens.resize(1);

  std::vector<Drawing> drawings;
  std::vector<EditSubject> logs;
  for (const fs::path& file : input.logs) {
    sculpt::StrokeLog log = sculpt::readLog(file);
    if (log.stampList)
      throw InputError(
          fmt::format("{}: a stamp list has no cameras; retargeting needs strokes", file.string()));
    addInput(results, file);
    if (options.smoke) log.header.density = std::min(log.header.density, kSmokeDensity);
    Drawing drawing = drawLog(file, log, options, execution);
    if (drawing.strokes.empty())
      throw InputError(fmt::format("{}: none of its strokes lands on its base", file.string()));
    drawings.push_back(std::move(drawing));
    logs.push_back({file.stem().string(), std::move(log)});
  }
  if (!pens.empty()) {
    for (const fs::path& pen : pens) addInput(results, pen);
    for (const RetargetBase& base : bases) {
      if (!base.file.empty()) addInput(results, base.file);
      Drawing drawing = drawPens(base, pens, options, execution);
      if (drawing.strokes.empty())
        results.notes.push_back(fmt::format("{}: left out, since no stroke lands on it", base.name));
      else
        drawings.push_back(std::move(drawing));
    }
    sculpt::PenOptions drawn;
    drawn.mode = sculpt::PenMode::Alternate;
    drawn.density = options.smoke ? kSmokeDensity : kEditDensity;
    for (const fs::path& pen : pens)
      logs.push_back({pen.stem().string(), sculpt::readPenStrokes(pen, drawn)});
  }
  std::erase_if(logs, [](const EditSubject& log) { return log.log.commands.size() < 3; });

  makeNamesUnique(drawings);
  for (const Drawing& drawing : drawings) measureSubject(drawing, options, execution, progress, results);
  // Another base, of the same kind of size: what the strokes were not drawn on.
  std::vector<RetargetBase> others;
  for (const RetargetBase& base : bases)
    if (base.name == "ellipsoid" || base.name == "lump" || base.name == "bunny") others.push_back(base);
  for (std::size_t i = 0; i < logs.size(); ++i) {
    measureEdits(logs[i], others, options, execution, results);
    if (progress) progress("edits of " + logs[i].name, i + 1, logs.size());
  }
  addPictures(drawings, options, execution, results);
  return results;
}

}  // namespace restroke::experiments
