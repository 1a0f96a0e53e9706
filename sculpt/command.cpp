#include "sculpt/command.h"

#include <type_traits>

namespace restroke::sculpt {

const Consequences* consequencesOf(const Command& command) {
  return std::visit(
      [](const auto& c) -> const Consequences* {
        if constexpr (std::is_base_of_v<Consequences, std::remove_cvref_t<decltype(c)>>)
          return &c;
        else
          return nullptr;
      },
      command);
}

Consequences* consequencesOf(Command& command) {
  return const_cast<Consequences*>(consequencesOf(std::as_const(command)));
}

}  // namespace restroke::sculpt
