#include "experiments/retarget/pictures.h"

#include <algorithm>
#include <map>

#include "points/images/cpu_renderer.h"

namespace restroke::experiments {
namespace {

using retarget::Method;

constexpr std::array kShown{Method::Fixed,  Method::Nearest, Method::Exact,
                            Method::Mapped, Method::Surface, Method::Aligned};
// Surfels of a base for each pixel of a picture, and the drawn strokes' width as a part of their brush's.
constexpr double kSamplesPerPixel = 0.6;
constexpr float kThinner = 0.4f;
constexpr std::size_t kStrokes = 12;

/// Strokes that were drawn together: those of the file that most are of.
std::vector<const DrawnStroke*> shownStrokes(const Drawing& drawing, std::optional<std::size_t> only) {
  if (only) return {&drawing.strokes[*only]};
  std::map<std::string, std::size_t> counts;
  for (const DrawnStroke& each : drawing.strokes) ++counts[each.source];
  const auto most = std::ranges::max_element(counts, {}, [](const auto& c) { return c.second; });
  std::vector<const DrawnStroke*> shown;
  for (const DrawnStroke& each : drawing.strokes)
    if (each.source == most->first && shown.size() < kStrokes) shown.push_back(&each);
  return shown;
}

class Painter {
 public:
  Painter(const Drawing& drawing, const implicit::Shape& image, const RowOptions& options,
          const Execution& execution)
      : strokes_(shownStrokes(drawing, options.only)), execution_(execution) {
    Box box = implicit::boundsOf(drawing.base);
    box.add(implicit::boundsOf(image));
    camera_ = frameSphere(box.center(), box.halfDiagonal(),
                          {.view = strokes_.front()->stroke.camera.view,
                           .width = options.size,
                           .height = options.size,
                           .fill = 1.2f});
  }

  [[nodiscard]] std::span<const DrawnStroke* const> strokes() const { return strokes_; }

  template <class CasterOf>
  [[nodiscard]] points::DisplayImage paint(const implicit::Shape& shape, const CasterOf& casterFor) const {
    const auto density =
        static_cast<float>(kSamplesPerPixel * camera_.width * camera_.height / implicit::areaOf(shape));
    points::SurfelModel model({.density = density}, {.cell = 0.2f * shape.ball().radius});
    std::vector<implicit::Primitive> all{{shape, implicit::Sign::Positive}};
    for (const DrawnStroke* stroke : strokes_) {
      sculpt::Brush brush = stroke->brush;
      brush.radius *= kThinner;
      brush.mode = sculpt::Mode::Add;
      brush.tip = {};
      brush.trace = sculpt::Trace::Stamps;
      brush.radii = sculpt::Radii::Keep;
      const auto outcome = sculpt::stampsAlong(stroke->stroke, brush, 0x1p-20f, casterFor(*stroke));
      const auto stamps = sculpt::primitivesOf(outcome, brush);
      all.insert(all.end(), stamps.begin(), stamps.end());
    }
    model.append(all, execution_);
    const std::vector<points::Surfel> surfels = model.surfels(execution_);
    std::vector<std::uint32_t> nodes(all.size(), 1);
    nodes[0] = 0;
    points::Scene scene{.surfels = surfels, .strokeOfPrimitive = nodes, .list = &model.list()};
    // Strokes stand out from what they are on more than an editor would have them.
    const points::RenderOptions look{
        .palette = {.base = {0.62f, 0.58f, 0.52f}, .added = {0.55f, 0.06f, 0.03f}}};
    return points::toDisplay(points::render(scene, camera_, look, execution_));
  }

 private:
  std::vector<const DrawnStroke*> strokes_;
  Execution execution_;
  Camera camera_;
};

}  // namespace

std::vector<std::pair<std::string, points::DisplayImage>> picturesOf(const Drawing& drawing,
                                                                     const ChangedBase& changed,
                                                                     const RowOptions& options,
                                                                     const Execution& execution) {
  std::vector<std::pair<std::string, points::DisplayImage>> pictures;
  const Painter painter(drawing, changed.change->image, options, execution);
  std::unique_ptr<retarget::Caster> exact;
  pictures.emplace_back("original",
                        painter.paint(drawing.base, [&](const DrawnStroke& stroke) -> retarget::Caster& {
                          exact = retarget::makeCaster(Method::Exact, *drawing.model, stroke.stroke.camera);
                          return *exact;
                        }));
  for (const Method method : kShown) {
    Follower follower(changed, method, execution);
    std::string name(retarget::nameOf(method));
    if (follower.fellBack()) name += ": " + changed.motion->verdict;
    pictures.emplace_back(std::move(name), painter.paint(changed.change->image,
                                                         [&](const DrawnStroke& stroke) -> retarget::Caster& {
                                                           return follower.casterFor(stroke);
                                                         }));
  }
  return pictures;
}

}  // namespace restroke::experiments
