#pragma once
// Histories that nobody would draw: every command, at random, whether it can be carried out or not.

#include <vector>

#include "sculpt/command.h"
#include "tests/support/brute_force.h"

namespace restroke::sculpt {

/// What strokes are drawn with, one as likely as any other.
using Methods = std::vector<retarget::Method>;

/// A command for a tree of `nodes` nodes. About half of them draw strokes; the others move the cursor, edit
/// the tree or change the base. Some refer to nodes that do not exist, or hang a branch from itself.
[[nodiscard]] Command randomCommand(restroke::testing::Random& random, std::size_t nodes,
                                    const Methods& methods);

}  // namespace restroke::sculpt
