#include "points/dexel/gl/gl_replay_work.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <bit>
#include <limits>

#include "implicit/parallel.h"
#include "points/dexel/gl/gl_line_replay_shaders.h"
#include "points/dexel/refine/line_start.h"

namespace restroke::points {

namespace {

void append(const ReplayWords& table, const ReplayPart::Tile& tile, ReplayRound& round) {
  const auto base = static_cast<std::uint32_t>(round.table.size());
  round.items.push_back(base);
  const std::size_t offsets = tile.endLine - tile.firstLine + 1;
  for (std::size_t k = 0; k < table.size(); ++k) round.table.push_back(table[k] + (k < offsets ? base : 0));
}

}  // namespace

ReplayWork::ReplayWork(const Task& task, const Limits& limits)
    : lines_(task.lines), basis_(task.basis), execution_(task.execution), out_(task.out), limits_(limits) {
  asked_.resize(lines_.from.size());
  for (std::size_t i = 0; i < asked_.size(); ++i) asked_[i] = lines_.from[i] < lines_.to[i] ? 1 : 0;
}

void ReplayWork::take(StepsOfTiles&& here, std::span<const HistoryStep> steps) {
  here_ = std::move(here);
  inArena(execution_, [&] { here_->makeLists(); });
  steps_.clear();
  for (const PlacedStep& step : here_->steps()) steps_.push_back(steps[step.step]);
  onLine_.emplace([this] { return StepsOnLine(steps_); });
}

std::size_t ReplayWork::lineOf(const ReplayPart& part, std::size_t line) const {
  return out_.lineAt(static_cast<int>(part.lines[line][0]), static_cast<int>(part.lines[line][1]));
}

CutLine ReplayWork::cutLine(const ReplayPart& part, std::size_t i) const {
  const FourWords& line = part.lines[i];
  return {lines_.family.line(static_cast<int>(line[0]), static_cast<int>(line[1])),
          std::bit_cast<float>(line[2]), std::bit_cast<float>(line[3])};
}

ReplayPart ReplayWork::nextPart(std::size_t& tile, std::uint8_t turn, std::size_t most) {
  ReplayPart part;
  const LineRectangle& tiles = here_->tiles();
  const int width = tiles.endColumn - tiles.firstColumn;
  for (; tile < here_->tileCount(); ++tile) {
    const int firstColumn = kReplayTile * (tiles.firstColumn + static_cast<int>(tile) % width),
              firstRow = kReplayTile * (tiles.firstRow + static_cast<int>(tile) / width);
    const auto begin = static_cast<std::uint32_t>(part.lines.size());
    bool isFull = false;
    for (int row = firstRow; row < std::min(firstRow + kReplayTile, lines_.family.height); ++row)
      for (int column = firstColumn; column < std::min(firstColumn + kReplayTile, lines_.family.width);
           ++column) {
        const std::size_t line = out_.lineAt(column, row);
        if (asked_[line] != turn) continue;
        isFull = isFull || part.lines.size() == most;
        if (isFull) continue;
        asked_[line] = 0;
        part.lines.push_back({static_cast<std::uint32_t>(column), static_cast<std::uint32_t>(row),
                              std::bit_cast<std::uint32_t>(lines_.from[line]),
                              std::bit_cast<std::uint32_t>(lines_.to[line])});
        part.lineTiles.push_back(static_cast<std::uint32_t>(part.tiles.size()));
      }
    const auto end = static_cast<std::uint32_t>(part.lines.size());
    if (begin < end) part.tiles.push_back({tile, begin, end});
    if (isFull) break;
  }
  return part;
}

// Several lines share a row of cells: what cells know of one of them they know of all.
ReplayWork::KnownOfTile ReplayWork::knownOf(const ReplayPart& part, const ReplayPart::Tile& tile) const {
  KnownOfTile of;
  LinePainter painter;
  std::vector<std::optional<std::array<int, 3>>> rows;
  for (std::uint32_t i = tile.firstLine; i < tile.endLine; ++i) {
    const CutLine line = cutLine(part, i);
    rows.push_back(basis_.known->rowOf(line.ray));
    const std::size_t k = i - tile.firstLine;
    const auto isLike = [&](std::size_t other) {
      const FourWords& others = part.lines[tile.firstLine + other];
      return rows[other] == rows[k] && others[2] == part.lines[i][2] && others[3] == part.lines[i][3];
    };
    std::size_t like = rows[k] ? 0 : k;
    while (like < k && !isLike(like)) ++like;
    if (like < k) {
      of.places.push_back(of.places[like]);
      continue;
    }
    startLine(painter, line, basis_.known);
    of.places.push_back(
        {static_cast<std::uint32_t>(of.pieces.size()), static_cast<std::uint32_t>(painter.pieces().size())});
    for (const LinePainter::Piece& piece : painter.pieces()) {
      of.pieces.push_back(std::bit_cast<std::uint32_t>(piece.begin));
      of.pieces.push_back(piece.owner);
    }
  }
  return of;
}

ReplayWords ReplayWork::knownOf(const ReplayPart& part) const {
  std::vector<KnownOfTile> tiles(part.tiles.size());
  inArena(execution_, [&] {
    tbb::parallel_for(std::size_t{0}, tiles.size(),
                      [&](std::size_t t) { tiles[t] = knownOf(part, part.tiles[t]); });
  });
  ReplayWords all;
  std::size_t base = 2 * part.lines.size();
  for (const KnownOfTile& of : tiles) {
    for (const auto& [at, count] : of.places) {
      all.push_back(static_cast<std::uint32_t>(base) + at);
      all.push_back(count);
    }
    base += of.pieces.size();
  }
  for (const KnownOfTile& of : tiles) all.insert(all.end(), of.pieces.begin(), of.pieces.end());
  return all;
}

bool ReplayWork::hasLongStart(const ReplayPart& part, std::size_t line) const {
  return basis_.start && basis_.start->endCount(lineOf(part, line)) > kMostReplayPieces / 2;
}

ReplayWords ReplayWork::startOf(const ReplayPart& part) const {
  ReplayWords places, all;
  LineEnds ends;
  for (std::size_t i = 0; i < part.lines.size(); ++i) {
    ends.clear();
    if (!hasLongStart(part, i)) basis_.start->read(lineOf(part, i), ends);
    places.push_back(static_cast<std::uint32_t>(2 * part.lines.size() + all.size()));
    places.push_back(static_cast<std::uint32_t>(ends.size()));
    for (const SpanEnd& end : ends) {
      all.push_back(std::bit_cast<std::uint32_t>(end.depth));
      all.push_back(end.normal);
    }
  }
  places.insert(places.end(), all.begin(), all.end());
  return places;
}

std::optional<ReplayRound> ReplayWork::nextRound(ReplayPart& part, std::span<const ReplayLineState> states) {
  constexpr std::size_t kItems = 4096, kJobs = std::size_t{1} << 14;
  std::vector<std::size_t> stops(part.tiles.size(), 0);  // of lists; 0: nothing in this round
  std::vector<Job> jobs;
  bool some = false;
  for (std::size_t t = 0; t < part.tiles.size(); ++t) {
    ReplayPart::Tile& tile = part.tiles[t];
    const std::span<const std::uint32_t> list = here_->of(tile.tile);
    if (tile.next == list.size()) continue;
    const auto lines = states.subspan(tile.firstLine, tile.endLine - tile.firstLine);
    if (std::all_of(lines.begin(), lines.end(),
                    [](const ReplayLineState& state) { return state.isDecided(); })) {
      tile.next = list.size();
      continue;
    }
    if (jobs.size() >= kJobs) continue;
    std::size_t stop = tile.next;
    for (std::size_t tabled = 0; stop < list.size() && stop - tile.next < kItems; ++stop)
      if (isTabled(list[stop])) {
        if (tabled++ == limits_.solids) break;
        jobs.push_back({&tile, list[stop], {}});
      }
    stops[t] = stop;
    some = true;
  }
  if (!some) return std::nullopt;
  inArena(execution_, [&] {
    tbb::parallel_for(std::size_t{0}, jobs.size(), [&](std::size_t j) { makeTable(part, states, jobs[j]); });
  });
  return roundOf(part, stops, jobs);
}

void ReplayWork::makeTable(const ReplayPart& part, std::span<const ReplayLineState> states, Job& job) {
  StepsOnLine& onLine = onLine_->local();
  const LineRectangle& rectangle = here_->steps()[job.step].lines;
  const std::uint32_t count = job.tile->endLine - job.tile->firstLine;
  std::vector<StepsOnLine::Stretch> stretches;
  job.table.resize(count + 1);
  for (std::uint32_t k = 0; k < count; ++k) {
    job.table[k] = count + 1 + static_cast<std::uint32_t>(2 * stretches.size());
    const std::size_t i = job.tile->firstLine + k;
    const auto column = static_cast<int>(part.lines[i][0]), row = static_cast<int>(part.lines[i][1]);
    if (states[i].isDecided() || column < rectangle.firstColumn || column >= rectangle.endColumn ||
        row < rectangle.firstRow || row >= rectangle.endRow)
      continue;
    onLine.stretchesOf(job.step, lines_.family.line(column, row), stretches);
  }
  job.table[count] = count + 1 + static_cast<std::uint32_t>(2 * stretches.size());
  // Beyond any depth there is.
  constexpr float kMost = std::numeric_limits<float>::max();
  for (const StepsOnLine::Stretch& stretch : stretches)
    for (const float depth : {stretch.enter, stretch.exit})
      job.table.push_back(std::bit_cast<std::uint32_t>(std::clamp(depth, -kMost, kMost)));
}

// Tiles whose items and tables the card cannot see all at once wait for a later round.
ReplayRound ReplayWork::roundOf(ReplayPart& part, std::span<const std::size_t> stops,
                                std::span<const Job> jobs) const {
  const std::size_t most = limits_.words;
  ReplayRound round;
  std::size_t job = 0;
  for (std::size_t t = 0; t < part.tiles.size(); ++t) {
    ReplayPart::Tile& tile = part.tiles[t];
    std::size_t words = 0, endJob = job;
    for (; endJob < jobs.size() && jobs[endJob].tile == &tile; ++endJob) words += jobs[endJob].table.size();
    const auto from = static_cast<std::uint32_t>(round.items.size());
    const bool fits = round.items.size() + 2 * (stops[t] - std::min(tile.next, stops[t])) <= most &&
                      round.table.size() + words <= most;
    if (stops[t] != 0 && (fits || round.items.empty())) {
      const std::span<const std::uint32_t> list = here_->of(tile.tile);
      for (; tile.next < stops[t]; ++tile.next) {
        const std::uint32_t step = list[tile.next];
        if (!isTabled(step)) {
          round.items.push_back(step);
          continue;
        }
        round.items.push_back(step | kReplayTabled);
        append(jobs[job++].table, tile, round);
      }
    }
    job = endJob;
    round.tiles.push_back({from, static_cast<std::uint32_t>(round.items.size()), tile.firstLine, 0});
  }
  return round;
}

// Row of tiles by row, as dexels may be changed.
void ReplayWork::writeLines(const ReplayPart& part, const ReplayWords& offsets, LineEnds& ends) {
  std::vector<std::size_t> rows{0};  // the first line of each row of tiles, and behind the last one
  for (std::size_t i = 1; i < part.lines.size(); ++i)
    if (part.lines[i][1] / kReplayTile != part.lines[i - 1][1] / kReplayTile) rows.push_back(i);
  rows.push_back(part.lines.size());
  inArena(execution_, [&] {
    tbb::parallel_for(std::size_t{1}, rows.size(), [&](std::size_t row) {
      for (std::size_t i = rows[row - 1]; i < rows[row]; ++i) {
        const std::span<SpanEnd> own = std::span(ends).subspan(offsets[i], offsets[i + 1] - offsets[i]);
        if (own.empty()) continue;
        complete(part, i, own);
        out_.write(lineOf(part, i), own);
      }
    });
  });
}

// The card's owners become operations, and normals that it could not tell are found.
void ReplayWork::complete(const ReplayPart& part, std::size_t line, std::span<SpanEnd> ends) {
  StepsOnLine& onLine = onLine_->local();
  for (std::size_t k = 0; k < ends.size(); ++k) {
    SpanEnd& end = ends[k];
    const auto inner = static_cast<std::uint32_t>(end.inner), outer = static_cast<std::uint32_t>(end.outer);
    const bool begins = k % 2 == 0;
    if (end.isCut()) {
      const std::uint32_t later = inner + 1 > outer + 1 ? inner : outer;
      if ((end.normal & kReplayAsk) != 0)
        end.normal = onLine.normalAt({end.depth, begins ? outer : inner, begins ? inner : outer, begins},
                                     cutLine(part, line).ray);
      else if (onLine.idOf(later) == OperationId::Initial)
        end.normal &= ~kPackedFlag;
    }
    end.inner = onLine.idOf(inner);
    end.outer = onLine.idOf(outer);
  }
}

void ReplayWork::replayOnCpu(const ReplayPart& part, std::span<const std::size_t> which) {
  std::vector<LineEnds> ends(which.size());
  inArena(execution_, [&] {
    tbb::parallel_for(std::size_t{0}, which.size(), [&](std::size_t w) {
      const std::size_t i = which[w];
      StepsOnLine& onLine = onLine_->local();
      LinePainter painter;
      const CutLine line = cutLine(part, i);
      startLine(painter, line, basis_.known);
      for (const std::uint32_t step : here_->of(part.tiles[part.lineTiles[i]].tile)) {
        if (!(painter.low() < painter.high())) break;
        onLine.paint(step, line, painter);
      }
      LineEnds before;
      if (basis_.start) basis_.start->read(lineOf(part, i), before);
      onLine.endsOf(painter, line, before, ends[w]);
    });
  });
  for (std::size_t w = 0; w < which.size(); ++w) out_.write(lineOf(part, which[w]), ends[w]);
}

}  // namespace restroke::points
