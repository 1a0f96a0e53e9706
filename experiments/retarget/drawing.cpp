#include "experiments/retarget/drawing.h"

#include <algorithm>
#include <variant>

#include "experiments/retarget/fine_mesh.h"
#include "experiments/text.h"
#include "retarget/anchors.h"
#include "retarget/measures.h"
#include "retarget/methods/exact.h"
#include "sculpt/document.h"
#include "sculpt/pen_strokes.h"

namespace restroke::experiments {
namespace {

// A stroke of fewer hits, or shorter than this many radii of its brush, has hardly any length to measure
// errors by.
constexpr std::size_t kLeastHits = 8;
constexpr double kLeastRadii = 3;

/// Keeps the strokes that land on the base, and of those as many as are wanted, evenly spread.
void choose(Drawing& drawing, std::vector<DrawnStroke> strokes, std::size_t wanted) {
  std::vector<DrawnStroke> landed;
  for (DrawnStroke& each : strokes) {
    each.trail = trailOn(*drawing.model, each.stroke, each.brush);
    const double length = retarget::lengthOf(retarget::curveOf(each.trail));
    if (each.hits().size() >= kLeastHits && length >= kLeastRadii * static_cast<double>(each.brush.radius))
      landed.push_back(std::move(each));
    else
      ++drawing.subject.beside;
  }
  for (const std::size_t i : thinned(landed.size(), wanted == 0 ? landed.size() : wanted))
    drawing.strokes.push_back(std::move(landed[i]));
  drawing.subject.strokes = drawing.strokes.size();
}

Drawing bare(const RetargetBase& base, const RetargetOptions& options, const Execution& execution) {
  Drawing drawing;
  drawing.base = base.shape;
  if (const implicit::PosedVolume* volume = base.shape.volume(); volume && volume->volume().parameters().mesh)
    // The same surface in triangles as fine as those of its images, so that both have the same ones.
    drawing.base = shapeOf(fineMeshOf(base.shape, {.edge = options.edge * sizeOf(base.shape),
                                                   .mostTriangles = options.triangles})
                               .mesh);
  drawing.model = modelOf(drawing.base, static_cast<double>(options.samples), execution);
  drawing.subject = {.name = base.name,
                     .tellsMotion = base.tellsMotion,
                     .size = sizeOf(base.shape),
                     .surfels = drawing.model->surfelCount()};
  return drawing;
}

void addStrokes(const sculpt::StrokeLog& log, const std::string& source, std::vector<DrawnStroke>& strokes) {
  for (const sculpt::Command& command : log.commands)
    if (const auto* each = std::get_if<sculpt::StrokeCommand>(&command))
      strokes.push_back({.source = source, .stroke = each->stroke, .brush = each->brush, .trail = {}});
}

}  // namespace

std::vector<Point> DrawnStroke::hits() const {
  std::vector<Point> points;
  for (const retarget::TrailPoint& p : trail.points)
    if (p.hit) points.push_back(p.hit->position);
  return points;
}

std::unique_ptr<const points::SurfelModel> modelOf(const implicit::Shape& shape, double samples,
                                                   const Execution& execution) {
  const auto density = static_cast<float>(samples / implicit::areaOf(shape));
  auto model =
      std::make_unique<points::SurfelModel>(points::SamplingOptions{.density = density},
                                            implicit::ClusterOptions{.cell = 0.2f * shape.ball().radius});
  const implicit::Primitive base{shape, implicit::Sign::Positive};
  model->append({&base, 1}, execution);
  return model;
}

retarget::Trail trailOn(const points::SurfelModel& model, const retarget::Stroke& stroke,
                        const sculpt::Brush& brush) {
  const auto exact = retarget::makeExactCaster({.model = model, .camera = stroke.camera});
  retarget::TrailRecorder recorder(*exact);
  // The grid moves centres, not hits: any will do.
  (void)sculpt::stampsAlong(stroke, brush, 0x1p-16f, recorder);
  retarget::Trail trail = recorder.take();
  retarget::setAnchors(trail, model.list(), [](implicit::PrimitiveId) { return retarget::OwnerKey{}; });
  return trail;
}

Drawing drawPens(const RetargetBase& base, const std::vector<std::filesystem::path>& pens,
                 const RetargetOptions& options, const Execution& execution) {
  Drawing drawing = bare(base, options, execution);
  std::vector<DrawnStroke> strokes;
  for (const std::filesystem::path& pen : pens)
    addStrokes(sculpt::readPenStrokes(pen, {.base = base.shape}), pen.stem().string(), strokes);
  choose(drawing, std::move(strokes), options.strokes);
  return drawing;
}

Drawing drawLog(const std::filesystem::path& file, const sculpt::StrokeLog& log,
                const RetargetOptions& options, const Execution& execution) {
  const RetargetBase base{.name = file.stem().string(),
                          .shape = log.header.base,
                          .tellsMotion = log.header.base.volume() != nullptr &&
                                         log.header.base.volume()->volume().parameters().mesh != nullptr};
  Drawing drawing = bare(base, options, execution);
  std::vector<DrawnStroke> strokes;
  addStrokes(log, file.stem().string(), strokes);
  choose(drawing, std::move(strokes), options.strokes);
  return drawing;
}

}  // namespace restroke::experiments
