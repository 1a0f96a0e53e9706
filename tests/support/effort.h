#pragma once
// How much a test may try.

namespace restroke::testing {

/// Built with address, thread or memory checks, which make everything ten to fifty times slower: the plain
/// builds try everything, these a part.
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
inline constexpr bool kSanitized = true;
#else
inline constexpr bool kSanitized = false;
#endif

}  // namespace restroke::testing
