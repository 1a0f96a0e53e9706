#pragma once
// A signed primitive (SPEC S1): what a shape's list is made of.

#include <cstdint>

#include "implicit/shape.h"

namespace restroke::implicit {

enum class Sign : std::uint8_t { Positive, Negative };  ///< adds, carves
enum class Side : std::uint8_t { Outside, Inside };

struct Primitive {
  Shape shape;
  Sign sign = Sign::Positive;
  bool operator==(const Primitive&) const = default;
};

/// Names a primitive of one PrimitiveList from its insertion to its removal, whatever is inserted or removed
/// elsewhere.
enum class PrimitiveId : std::uint32_t {};

}  // namespace restroke::implicit
