#include "experiments/backends/surfel_delta.h"

#include <zstd.h>

#include <cstring>

#include "implicit/errors.h"

namespace restroke::experiments {
namespace {

using points::Surfel;

constexpr int kLevel = 3;          // zstd's own default: an editor compresses while the pen is up
constexpr std::size_t kWords = 9;  // 32-bit columns of a surfel: 3 position, 3 normal, radius, owner, sign

/// Column c of a surfel as a word.
std::uint32_t wordOf(const Surfel& s, std::size_t c) {
  const float values[] = {s.position.x, s.position.y, s.position.z, s.normal.x,
                          s.normal.y,   s.normal.z,   s.radius};
  std::uint32_t word = 0;
  if (c < 7)
    std::memcpy(&word, &values[c], sizeof word);
  else
    word = c == 7 ? s.primitive : static_cast<std::uint32_t>(s.sign);
  return word;
}

/// Bit for bit: -0 and 0 are told apart, so that a restored state has the hash of the original.
bool same(const Surfel& a, const Surfel& b) {
  for (std::size_t c = 0; c < kWords; ++c)
    if (wordOf(a, c) != wordOf(b, c)) return false;
  return true;
}

void appendColumns(std::vector<std::uint32_t>& words, std::span<const Surfel> surfels) {
  for (std::size_t c = 0; c < kWords; ++c) {
    std::uint32_t last = 0;
    for (const Surfel& s : surfels) {
      const std::uint32_t word = wordOf(s, c);
      words.push_back(c == 7 ? word - last : word);  // owners grow slowly along the list
      last = word;
    }
  }
}

std::vector<Surfel> readColumns(std::span<const std::uint32_t> words, std::size_t count) {
  std::vector<Surfel> surfels(count);
  const auto real = [&](std::size_t c, std::size_t i) {
    float value = 0;
    std::memcpy(&value, &words[c * count + i], sizeof value);
    return value;
  };
  std::uint32_t owner = 0;
  for (std::size_t i = 0; i < count; ++i) {
    Surfel& s = surfels[i];
    s.position = {real(0, i), real(1, i), real(2, i)};
    s.normal = {real(3, i), real(4, i), real(5, i)};
    s.radius = real(6, i);
    s.primitive = owner += words[7 * count + i];
    s.sign = static_cast<implicit::Sign>(words[8 * count + i]);
  }
  return surfels;
}

}  // namespace

SurfelDelta difference(std::span<const Surfel> before, std::span<const Surfel> after) {
  SurfelDelta delta;
  std::size_t kept = 0;
  for (std::size_t i = 0; i < before.size(); ++i) {
    if (kept < after.size() && same(before[i], after[kept]))
      ++kept;
    else
      delta.removedAt.push_back(static_cast<std::uint32_t>(i));
  }
  delta.removed.reserve(delta.removedAt.size());
  for (const std::uint32_t i : delta.removedAt) delta.removed.push_back(before[i]);
  delta.added.assign(after.begin() + static_cast<std::ptrdiff_t>(kept), after.end());
  delta.removedAt.shrink_to_fit();
  return delta;
}

void applyForward(const SurfelDelta& delta, std::vector<Surfel>& state) {
  std::size_t to = 0, next = 0;
  for (std::size_t from = 0; from < state.size(); ++from) {
    if (next < delta.removedAt.size() && delta.removedAt[next] == from)
      ++next;
    else
      state[to++] = state[from];
  }
  RESTROKE_CHECK_EQ(next, delta.removedAt.size());
  state.resize(to);
  state.insert(state.end(), delta.added.begin(), delta.added.end());
}

void applyBackward(const SurfelDelta& delta, std::vector<Surfel>& state) {
  RESTROKE_CHECK_LE(delta.added.size(), state.size());
  std::size_t from = state.size() - delta.added.size();  // end of the kept ones
  state.resize(from + delta.removed.size());
  // From the back, so that nothing is overwritten before it has moved.
  std::size_t left = delta.removed.size();
  for (std::size_t to = state.size(); to-- > 0 && left > 0;) {
    if (delta.removedAt[left - 1] == to)
      state[to] = delta.removed[--left];
    else
      state[to] = state[--from];
  }
  RESTROKE_CHECK_EQ(left, std::size_t{0});
}

std::vector<char> compress(const SurfelDelta& delta) {
  std::vector<std::uint32_t> words;
  words.reserve(2 + delta.removedAt.size() + kWords * (delta.removed.size() + delta.added.size()));
  words.push_back(static_cast<std::uint32_t>(delta.removed.size()));
  words.push_back(static_cast<std::uint32_t>(delta.added.size()));
  std::uint32_t last = 0;
  for (const std::uint32_t i : delta.removedAt) {
    words.push_back(i - last);
    last = i;
  }
  appendColumns(words, delta.removed);
  appendColumns(words, delta.added);
  const std::size_t size = words.size() * sizeof(std::uint32_t);
  std::vector<char> bound(ZSTD_compressBound(size));
  const std::size_t written = ZSTD_compress(bound.data(), bound.size(), words.data(), size, kLevel);
  if (ZSTD_isError(written)) throw InternalError(fmt::format("zstd: {}", ZSTD_getErrorName(written)));
  return {bound.begin(), bound.begin() + static_cast<std::ptrdiff_t>(written)};
}

SurfelDelta decompress(std::span<const char> bytes) {
  const unsigned long long size = ZSTD_getFrameContentSize(bytes.data(), bytes.size());
  if (size == ZSTD_CONTENTSIZE_ERROR || size == ZSTD_CONTENTSIZE_UNKNOWN ||
      size % sizeof(std::uint32_t) != 0 || size < 8)
    throw InternalError("surfel delta: not a compressed delta");
  std::vector<std::uint32_t> words(size / sizeof(std::uint32_t));
  const std::size_t read = ZSTD_decompress(words.data(), size, bytes.data(), bytes.size());
  if (ZSTD_isError(read)) throw InternalError(fmt::format("zstd: {}", ZSTD_getErrorName(read)));
  RESTROKE_CHECK_EQ(read, static_cast<std::size_t>(size));
  const std::size_t removed = words[0], added = words[1];
  RESTROKE_CHECK_EQ(words.size(), 2 + removed + kWords * (removed + added));
  SurfelDelta delta;
  delta.removedAt.resize(removed);
  std::uint32_t last = 0;
  for (std::size_t i = 0; i < removed; ++i) delta.removedAt[i] = last += words[2 + i];
  const auto columns = std::span<const std::uint32_t>(words).subspan(2 + removed);
  delta.removed = readColumns(columns.first(kWords * removed), removed);
  delta.added = readColumns(columns.subspan(kWords * removed), added);
  return delta;
}

}  // namespace restroke::experiments
