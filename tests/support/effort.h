#pragma once
// How much a test may try.

// GCC names its sanitizers by macros; clang has features, which may be asked for in #if only (as of GCC 14).
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define RESTROKE_SANITIZED 1
#elif defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer) || __has_feature(memory_sanitizer)
#define RESTROKE_SANITIZED 1
#endif
#endif
#ifndef RESTROKE_SANITIZED
#define RESTROKE_SANITIZED 0
#endif

namespace restroke::testing {

/// Built with address, thread or memory checks, by GCC or clang, which make everything ten to fifty times
/// slower: the plain builds try everything, these a part.
inline constexpr bool kSanitized = RESTROKE_SANITIZED != 0;

}  // namespace restroke::testing
