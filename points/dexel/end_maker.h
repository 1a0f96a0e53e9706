#pragma once
// Which operation an end shows. Internal to points/dexel.

#include "implicit/primitive.h"
#include "points/dexel/span_end.h"

namespace restroke::points {

/// For surfels and pictures: the operation that made the end (0: the initial solid, or not known), and
/// whether it took away.
struct EndMaker {
  std::uint32_t operation;
  implicit::Sign sign;
};

/// Of the operations on the two sides of an end the later one made it. Without operations cut ends count as
/// taken away.
[[nodiscard]] inline EndMaker makerOf(const SpanEnd& end, bool keepsOperations) {
  using implicit::Sign;
  if (!keepsOperations) return {0, end.isCut() ? Sign::Negative : Sign::Positive};
  const bool cleared =
      end.outer != OperationId::None && (end.inner == OperationId::None || end.outer > end.inner);
  if (cleared) return {static_cast<std::uint32_t>(end.outer), Sign::Negative};
  return {end.inner == OperationId::None ? 0 : static_cast<std::uint32_t>(end.inner), Sign::Positive};
}

}  // namespace restroke::points
