// Linear prediction and adaptive Golomb-Rice codes: R. F. Rice, Some practical universal noiseless coding
// techniques, JPL 1979, with the parameter taken from a running mean as JPEG-LS does (Weinberger, Seroussi,
// Sapiro, The LOCO-I lossless image compression algorithm, 2000, section III.B). We differ in the running
// mean (four values of memory, a power of two, so that a pen that slows down is followed at once) and in
// choosing one of four predictors a channel.
//
// Everything is integers: the bytes are the same on every machine.

#include "retarget/stroke_codec.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <string>

#include "implicit/errors.h"

namespace restroke::retarget {
namespace {

/// How a value is foretold from those before it. The numbers are the format's.
enum class Predictor : unsigned {
  Line = 0,    // every difference is the same: the channel is first value and step, and costs nothing a point
  Same = 1,    // the last value
  Linear = 2,  // the last value and the whole last difference
  Damped = 3,  // the last value and three quarters of the last difference
  Smooth = 4,  // the last value and the mean of the last two differences
};
constexpr std::array kCodedPredictors{Predictor::Same, Predictor::Linear, Predictor::Damped,
                                      Predictor::Smooth};

constexpr unsigned kPredictorBits = 3;
constexpr unsigned kParameterBits = 5;  // first Rice parameter, 0 to 31
constexpr unsigned kWidthBits = 6;      // width of a number that follows
constexpr unsigned kEscape = 12;        // a run of this many ones: the number follows with its width
// Differences of time reach 2^31, predictions thrice that, zigzag doubles: 2^34. Widths beyond are malformed.
constexpr unsigned kMaxWidth = 36;
constexpr unsigned kMeanShift = 2;  // the running mean remembers about 2^2 values
constexpr std::size_t kFirstMeanCount = 16;
// The predictor is chosen by the first points: trying it on more changes the choice rarely and the bytes
// hardly.
constexpr std::size_t kTriedPoints = 1024;
constexpr std::uint64_t kMaxCount = kMaxTime;

constexpr std::uint64_t zigzag(std::int64_t v) {
  return (static_cast<std::uint64_t>(v) << 1) ^ static_cast<std::uint64_t>(v >> 63);
}
constexpr std::int64_t unzigzag(std::uint64_t u) {
  return static_cast<std::int64_t>(u >> 1) ^ -static_cast<std::int64_t>(u & 1);
}
unsigned widthOf(std::uint64_t u) {
  return static_cast<unsigned>(std::bit_width(u));
}

struct Channel {
  const char* name;
  std::int64_t min, max;
  bool mayBeLine;  // the x channel may not: one bit a point at least is what bounds the count of points by
                   // the bytes
  std::int64_t (*get)(const StrokePoint&);
  void (*set)(StrokePoint&, std::int64_t);
};

constexpr std::array<Channel, 4> kChannels{{
    {"x", -kMaxScreen, kMaxScreen, false, [](const StrokePoint& p) { return std::int64_t{p.screen.x}; },
     [](StrokePoint& p, std::int64_t v) { p.screen.x = static_cast<std::int32_t>(v); }},
    {"y", -kMaxScreen, kMaxScreen, true, [](const StrokePoint& p) { return std::int64_t{p.screen.y}; },
     [](StrokePoint& p, std::int64_t v) { p.screen.y = static_cast<std::int32_t>(v); }},
    {"time", 0, kMaxTime, true, [](const StrokePoint& p) { return std::int64_t{p.time}; },
     [](StrokePoint& p, std::int64_t v) { p.time = static_cast<std::uint32_t>(v); }},
    {"pressure", 0, kMaxPressure, true, [](const StrokePoint& p) { return std::int64_t{p.pressure}; },
     [](StrokePoint& p, std::int64_t v) { p.pressure = static_cast<std::uint16_t>(v); }},
}};

bool isPacked(std::size_t channel, PackedChannels channels) {
  return channel < 2 || (channel == 2 ? channels.time : channels.pressure);
}

/// The last value and the last two differences of a channel.
struct Past {
  std::int64_t value = 0, d1 = 0, d2 = 0;

  explicit Past(std::int64_t first) : value(first) {}
  [[nodiscard]] std::int64_t predict(Predictor predictor) const {
    switch (predictor) {
      case Predictor::Linear:
        return value + d1;
      case Predictor::Damped:
        return value + ((3 * d1) >> 2);
      case Predictor::Smooth:
        return value + ((d1 + d2) >> 1);
      default:
        return value;
    }
  }
  void push(std::int64_t next) {
    const bool second = d1 == 0 && d2 == 0;
    d2 = d1;
    d1 = next - value;
    // From rest, the first difference stands for both: a stroke's second point says how fast it goes.
    if (second) d2 = d1;
    value = next;
  }
};

/// The Rice parameter, from the mean of the numbers so far.
class Parameter {
 public:
  explicit Parameter(unsigned first) : sum_(first == 0 ? 0 : std::uint64_t{1} << (first + kMeanShift)) {}
  [[nodiscard]] unsigned get() const {
    const std::uint64_t mean = sum_ >> kMeanShift;
    return mean == 0 ? 0 : widthOf(mean) - 1;
  }
  void push(std::uint64_t number) { sum_ += number - (sum_ >> kMeanShift); }

 private:
  std::uint64_t sum_;
};

/// Bits into bytes, the lowest bit of each byte first.
class BitWriter {
 public:
  explicit BitWriter(std::vector<std::uint8_t>& out) : out_(out) {}
  /// `width` at most 40.
  void put(std::uint64_t bits, unsigned width) {
    held_ |= bits << count_;
    count_ += width;
    while (count_ >= 8) {
      out_.push_back(static_cast<std::uint8_t>(held_));
      held_ >>= 8;
      count_ -= 8;
    }
  }
  void putSized(std::uint64_t u) {
    const unsigned width = widthOf(u);
    put(width, kWidthBits);
    put(u, width);
  }
  void putRice(std::uint64_t u, unsigned k) {
    const std::uint64_t ones = u >> k;
    if (ones < kEscape) {
      put((std::uint64_t{1} << ones) - 1, static_cast<unsigned>(ones) + 1);
      put(u & ((std::uint64_t{1} << k) - 1), k);
    } else {
      put((std::uint64_t{1} << kEscape) - 1, kEscape);
      putSized(u);
    }
  }
  void finish() {
    if (count_ > 0) out_.push_back(static_cast<std::uint8_t>(held_));
    held_ = 0;
    count_ = 0;
  }

 private:
  std::vector<std::uint8_t>& out_;
  std::uint64_t held_ = 0;
  unsigned count_ = 0;
};

class BitReader {
 public:
  explicit BitReader(std::span<const std::uint8_t> in) : in_(in) {}
  [[nodiscard]] std::uint64_t get(unsigned width) {
    if (count_ < width) refill();
    if (count_ < width) fail("they end early");
    const std::uint64_t bits = held_ & ((std::uint64_t{1} << width) - 1);
    held_ >>= width;
    count_ -= width;
    return bits;
  }
  [[nodiscard]] std::uint64_t getSized() {
    const auto width = static_cast<unsigned>(get(kWidthBits));
    if (width > kMaxWidth) fail(fmt::format("a number is {} bits wide, the widest are {}", width, kMaxWidth));
    return get(width);
  }
  [[nodiscard]] std::uint64_t getRice(unsigned k) {
    if (count_ <= kEscape) refill();
    const auto ones = std::min(static_cast<unsigned>(std::countr_one(held_)), kEscape);
    if (ones == kEscape) {
      static_cast<void>(get(kEscape));
      return getSized();
    }
    static_cast<void>(get(ones + 1));
    return (std::uint64_t{ones} << k) | get(k);
  }
  /// Bits that are left, the ones that fill up the last byte included.
  [[nodiscard]] std::size_t left() const { return count_ + 8 * (in_.size() - next_); }
  /// Skips to the next whole byte and says how many bytes were read.
  [[nodiscard]] std::size_t finish() {
    if (get(count_ % 8) != 0) fail("the bits that fill up the last byte are not 0");
    return next_ - count_ / 8;
  }
  [[noreturn]] void fail(const std::string& what) const {
    throw InputError(fmt::format("packed stroke points, byte {}: {}", next_ - count_ / 8, what));
  }

 private:
  void refill() {
    while (count_ <= 56 && next_ < in_.size()) {
      held_ |= static_cast<std::uint64_t>(in_[next_++]) << count_;
      count_ += 8;
    }
  }

  std::span<const std::uint8_t> in_;
  std::size_t next_ = 0;
  std::uint64_t held_ = 0;  // bits above count_ are 0
  unsigned count_ = 0;
};

bool isLine(std::span<const StrokePoint> points, const Channel& channel) {
  const std::int64_t step = channel.get(points[1]) - channel.get(points[0]);
  for (std::size_t i = 2; i < points.size(); ++i)
    if (channel.get(points[i]) - channel.get(points[i - 1]) != step) return false;
  return true;
}

struct Choice {
  Predictor predictor = Predictor::Same;
  unsigned parameter = 0;
};

/// The predictor that leaves the narrowest numbers at the stroke's beginning. Widths stand in for code
/// lengths: one pass, no trial encoding.
Choice choose(std::span<const StrokePoint> points, const Channel& channel) {
  std::array<std::uint64_t, kCodedPredictors.size()> widths{}, firstSums{};
  Past past(channel.get(points[0]));
  for (std::size_t i = 1; i < std::min(points.size(), kTriedPoints); ++i) {
    const std::int64_t value = channel.get(points[i]);
    for (std::size_t j = 0; j < kCodedPredictors.size(); ++j) {
      const std::uint64_t u = zigzag(value - past.predict(kCodedPredictors[j]));
      widths[j] += widthOf(u);
      if (i <= kFirstMeanCount) firstSums[j] += u;
    }
    past.push(value);
  }
  const auto best = static_cast<std::size_t>(std::min_element(widths.begin(), widths.end()) - widths.begin());
  const std::uint64_t mean = firstSums[best] / std::min(points.size() - 1, kFirstMeanCount);
  const unsigned parameter = mean == 0 ? 0 : std::min(widthOf(mean) - 1, (1u << kParameterBits) - 1);
  return {kCodedPredictors[best], parameter};
}

void encodeChannel(std::span<const StrokePoint> points, const Channel& channel, BitWriter& writer) {
  writer.putSized(zigzag(channel.get(points[0])));
  if (points.size() == 1) return;
  if (channel.mayBeLine && isLine(points, channel)) {
    writer.put(static_cast<unsigned>(Predictor::Line), kPredictorBits);
    writer.putSized(zigzag(channel.get(points[1]) - channel.get(points[0])));
    return;
  }
  const Choice choice = choose(points, channel);
  writer.put(static_cast<unsigned>(choice.predictor), kPredictorBits);
  writer.put(choice.parameter, kParameterBits);
  Past past(channel.get(points[0]));
  Parameter parameter(choice.parameter);
  for (const StrokePoint& point : points.subspan(1)) {
    const std::int64_t value = channel.get(point);
    const std::uint64_t u = zigzag(value - past.predict(choice.predictor));
    writer.putRice(u, parameter.get());
    parameter.push(u);
    past.push(value);
  }
}

std::int64_t inRange(std::int64_t value, const Channel& channel, const BitReader& reader) {
  if (value < channel.min || value > channel.max)
    reader.fail(
        fmt::format("{} is {}, out of its range of {} to {}", channel.name, value, channel.min, channel.max));
  return value;
}

void decodeChannel(std::span<StrokePoint> points, const Channel& channel, BitReader& reader) {
  const std::int64_t first = inRange(unzigzag(reader.getSized()), channel, reader);
  channel.set(points[0], first);
  if (points.size() == 1) return;
  const auto code = static_cast<unsigned>(reader.get(kPredictorBits));
  if (code > static_cast<unsigned>(Predictor::Smooth) || (code == 0 && !channel.mayBeLine))
    reader.fail(fmt::format("{} has the unknown predictor {}", channel.name, code));
  const auto predictor = static_cast<Predictor>(code);
  if (predictor == Predictor::Line) {
    const std::int64_t step = unzigzag(reader.getSized());
    std::int64_t value = first;
    for (StrokePoint& point : points.subspan(1))
      channel.set(point, value = inRange(value + step, channel, reader));
    return;
  }
  Parameter parameter(static_cast<unsigned>(reader.get(kParameterBits)));
  Past past(first);
  for (StrokePoint& point : points.subspan(1)) {
    const std::uint64_t u = reader.getRice(parameter.get());
    const std::int64_t value = inRange(past.predict(predictor) + unzigzag(u), channel, reader);
    channel.set(point, value);
    parameter.push(u);
    past.push(value);
  }
}

}  // namespace

void encodePoints(std::span<const StrokePoint> points, std::vector<std::uint8_t>& out,
                  PackedChannels channels) {
  if (points.size() > kMaxCount)
    throw InputError(
        fmt::format("a stroke of {} points cannot be packed, at most {} can", points.size(), kMaxCount));
  for (std::size_t c = 0; c < kChannels.size(); ++c) {
    if (!isPacked(c, channels)) continue;
    for (std::size_t i = 0; i < points.size(); ++i) {
      const std::int64_t value = kChannels[c].get(points[i]);
      if (value < kChannels[c].min || value > kChannels[c].max)
        throw InputError(fmt::format("point {}: {} is {}, out of its range of {} to {}", i, kChannels[c].name,
                                     value, kChannels[c].min, kChannels[c].max));
    }
  }
  BitWriter writer(out);
  writer.put(channels.time ? 1 : 0, 1);
  writer.put(channels.pressure ? 1 : 0, 1);
  writer.putSized(points.size());
  for (std::size_t c = 0; c < kChannels.size() && !points.empty(); ++c)
    if (isPacked(c, channels)) encodeChannel(points, kChannels[c], writer);
  writer.finish();
}

std::vector<StrokePoint> decodePoints(std::span<const std::uint8_t>& in) {
  BitReader reader(in);
  PackedChannels channels;
  channels.time = reader.get(1) != 0;
  channels.pressure = reader.get(1) != 0;
  const std::uint64_t count = reader.getSized();
  // Every point but the first takes a bit or more of the x channel: a count beyond the bits that are left is
  // a lie, found before any memory is taken.
  if (count > reader.left())
    reader.fail(
        fmt::format("{} points are announced, more than the {} bits left can hold", count, reader.left()));
  std::vector<StrokePoint> points(static_cast<std::size_t>(count));
  for (std::size_t c = 0; c < kChannels.size() && !points.empty(); ++c)
    if (isPacked(c, channels)) decodeChannel(points, kChannels[c], reader);
  in = in.subspan(reader.finish());
  return points;
}

}  // namespace restroke::retarget
