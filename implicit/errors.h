#pragma once
// What the program says when its input or its own logic is wrong.

#include <fmt/format.h>

#include <stdexcept>
#include <string>

namespace restroke {

/// Bad input: a file, an option or a value that breaks a stated rule. `what()` is one sentence that says
/// where (file, line or byte, option), what was found and which rule it breaks. The command line prints it
/// and exits 2.
class InputError : public std::runtime_error {
 public:
  explicit InputError(const std::string& sentence) : std::runtime_error(sentence) {}
};

/// A bug of ours: an invariant that does not hold. The command line prints it and exits 1.
class InternalError : public std::logic_error {
 public:
  explicit InternalError(const std::string& sentence) : std::logic_error(sentence) {}
};

}  // namespace restroke

/// Stops with both operands when an invariant of ours does not hold. Always on: the operands are cheap.
#define RESTROKE_CHECK_OP(op, a, b)                                                                      \
  do {                                                                                                   \
    const auto restrokeA = (a);                                                                          \
    const auto restrokeB = (b);                                                                          \
    if (!(restrokeA op restrokeB))                                                                       \
      throw ::restroke::InternalError(fmt::format("{}:{}: check failed: {} {} {} ({} and {})", __FILE__, \
                                                  __LINE__, #a, #op, #b, restrokeA, restrokeB));         \
  } while (false)
#define RESTROKE_CHECK_EQ(a, b) RESTROKE_CHECK_OP(==, a, b)
#define RESTROKE_CHECK_LT(a, b) RESTROKE_CHECK_OP(<, a, b)
#define RESTROKE_CHECK_LE(a, b) RESTROKE_CHECK_OP(<=, a, b)
