#include "experiments/examples/example_logs.h"

#include "implicit/errors.h"

namespace restroke::experiments {

sculpt::StrokeLog exampleLog(std::string_view name) {
  if (name == "table2") return table2Log();
  if (name == "paper-scale") return paperScaleLog();
  if (name == "rabbit") return rabbitLog();
  if (name == "figure10") return figure10().log;
  if (name == "gallery") return galleryLog();
  throw InputError(fmt::format(
      "example: no example is called '{}'; there are table2, paper-scale, rabbit, figure10 and gallery",
      name));
}

}  // namespace restroke::experiments
