// Lines are worked on in parts, and a part in rounds: each takes the next steps of every tile that has
// undecided lines. When all lines are decided, or steps are done, their ends are counted, summed up, written,
// and brought back.

#include "points/dexel/gl/gl_line_replay.h"

#include <epoxy/gl.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <bit>
#include <limits>
#include <memory>
#include <optional>

#include "implicit/errors.h"
#include "implicit/parallel.h"
#include "points/dexel/gl/gl_dexel_shaders.h"
#include "points/dexel/gl/gl_dexel_state.h"
#include "points/dexel/gl/gl_line_replay_shaders.h"
#include "points/dexel/gl/gl_replay_tiles.h"
#include "points/dexel/refine/line_start.h"
#include "points/dexel/refine/steps_on_line.h"

namespace restroke::points {

namespace {

using Words = std::vector<std::uint32_t>;
using Four = std::array<std::uint32_t, 4>;

GlProgram replayProgram(std::initializer_list<const char*> pieces) {
  std::string text = std::string(kDexelHead) + kLineItems + kReplayHead + kReplayPieces;
  for (const char* piece : pieces) text += piece;
  return GlProgram(text);
}

}  // namespace

struct GlReplayParts {
  explicit GlReplayParts(const GlDexelContext::State& state)
      : lines(state.newBuffer()),
        lineTiles(state.newBuffer()),
        tiles(state.newBuffer()),
        items(state.newBuffer()),
        table(state.newBuffer()),
        balls(state.newBuffer()),
        pieces(state.newBuffer()),
        states(state.newBuffer()),
        before(state.newBuffer()) {
    checkGlErrors("the programs for replays");
  }

  // The shaders' constants.
  static constexpr std::uint32_t kTabled = 0x80000000u, kAsk = 0x40000000u, kOverflow = 0xffffffffu;

  GlProgram start = replayProgram({kReplayStartMain}),
            paint = replayProgram({kReplayBalls, kReplayPaintMain}),
            countEnds = replayProgram({kScan, kReplayBalls, kReplayEndsMain}),
            writeEnds = replayProgram({"#define WRITES\n", kTakeOffset, kReplayBalls, kReplayEndsMain});
  GlBuffer lines, lineTiles, tiles, items, table, balls, pieces, states;
  GlBuffer before;  // what is known of lines
};

GlReplayParts& GlDexelContext::State::replayParts() {
  if (!replayParts_) replayParts_ = std::make_shared<GlReplayParts>(*this);
  return *replayParts_;
}

namespace {

// Some lines that are worked on together, tile by tile.
struct Part {
  struct Tile {
    std::size_t tile;                  // of the rectangle's
    std::uint32_t firstLine, endLine;  // of the part's
    std::size_t next = 0;              // of the tile's list
  };
  std::vector<Tile> tiles;
  std::vector<Four> lines;  // column, row, from, to
  Words lineTiles;
};

// What a round hands to the card.
struct Round {
  Words items, table;
  std::vector<Four> tiles;  // one for each of the part's: items from, to; first line
};

// As the shaders have it.
struct LineState {
  static constexpr std::uint32_t kNone = 0xffffffffu;
  std::uint32_t pieces, open, item, stretch;
  [[nodiscard]] bool isDecided() const { return open == kNone; }
  [[nodiscard]] bool isStopped() const { return item != kNone; }
};
constexpr std::size_t kBytesPerPiece = 16;

class Replay {
 public:
  Replay(GlDexelContext::State& state, const GlLineReplay::Options& options, const LinesInZone& lines,
         const ReplayBasis& basis)
      : state_(state), parts_(state.replayParts()), options_(options), lines_(lines), basis_(basis) {
    asked_.resize(lines.from.size());
    for (std::size_t i = 0; i < asked_.size(); ++i) asked_[i] = lines.from[i] < lines.to[i] ? 1 : 0;
    const LineFamily& f = lines.family;
    const DVec3 vectors[] = {f.origin,    f.originStep,    f.originRowStep,
                             f.direction, f.directionStep, f.directionRowStep};
    for (const DVec3& v : vectors)
      for (int a = 0; a < 3; ++a) family_.push_back(v[a]);
  }

  void run(std::span<const HistoryStep> steps, const Execution& execution, Dexels& out) {
    execution_ = execution;
    out_ = &out;
    const std::vector<PlacedStep> placed = placedSteps(steps, lines_.family);
    run(steps, placed, tilesOf({0, lines_.family.width, 0, lines_.family.height}));
  }

 private:
  void run(std::span<const HistoryStep> steps, std::span<const PlacedStep> placed,
           const LineRectangle& tiles) {
    StepsOfTiles here(placed, tiles);
    if (here.tileCount() == 0 || (here.steps().empty() && !basis_.start && !basis_.known)) return;
    if (here.tileCount() > 1 &&
        (here.pairCount() > options_.pairs || here.steps().size() > state_.largestBlock() / sizeof(Four))) {
      LineRectangle first = tiles, second = tiles;
      if (tiles.endRow - tiles.firstRow > 1)
        first.endRow = second.firstRow = (tiles.firstRow + tiles.endRow) / 2;
      else
        first.endColumn = second.firstColumn = (tiles.firstColumn + tiles.endColumn) / 2;
      run(steps, here.steps(), first);
      run(steps, here.steps(), second);
      return;
    }
    here_ = &here;
    inArena(execution_, [&] { here.makeLists(); });
    steps_.clear();
    for (const PlacedStep& step : here.steps()) steps_.push_back(steps[step.step]);
    onLine_.emplace([this] { return StepsOnLine(steps_); });
    writeBalls();
    const std::size_t pieces = state_.largestBlock() / kBytesPerPiece;
    std::uint8_t turn = 1;
    room_ = std::min<std::size_t>(options_.room, kMostReplayPieces);
    for (bool again = true; again; room_ = std::min<std::size_t>(8 * room_, kMostReplayPieces), ++turn) {
      again = false;
      const std::size_t most = std::clamp<std::size_t>(pieces / room_, 1, options_.lines);
      std::size_t tile = 0;
      for (Part part = nextPart(tile, turn, most); !part.lines.empty(); part = nextPart(tile, turn, most))
        again = replayPart(part, static_cast<std::uint8_t>(turn + 1)) || again;
    }
  }

  void writeBalls() {
    std::vector<Four> balls;
    balls.reserve(steps_.size());
    for (const HistoryStep& step : steps_) {
      const bool fills = step.operation == DexelOperation::Union;
      implicit::Sphere ball{Point(0), std::numeric_limits<float>::infinity()};
      if (step.ball && step.operation != DexelOperation::Intersection) ball = *step.ball;
      const auto bits = [](float x) { return std::bit_cast<std::uint32_t>(x); };
      balls.push_back({bits(ball.center.x), bits(ball.center.y), bits(ball.center.z),
                       bits(fills ? ball.radius : -ball.radius)});
    }
    parts_.balls.write(balls.data(), balls.size() * sizeof balls[0]);
  }

  // Lines whose turn it is, from a tile on; they are not asked any more. `tile` becomes the one to go on
  // with.
  [[nodiscard]] Part nextPart(std::size_t& tile, std::uint8_t turn, std::size_t most) {
    Part part;
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
          const std::size_t line = out_->lineAt(column, row);
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

  // True: some lines have more pieces than there is room for; their turn is the one that is told.
  bool replayPart(Part& part, std::uint8_t nextTurn) {
    const std::size_t count = part.lines.size();
    parts_.lines.write(part.lines.data(), count * sizeof part.lines[0]);
    parts_.lineTiles.write(part.lineTiles.data(), count * sizeof part.lineTiles[0]);
    parts_.pieces.reserve(count * room_ * kBytesPerPiece);
    parts_.states.reserve(count * sizeof(LineState));
    start(part);
    std::vector<LineState> states(count, {1, 0, LineState::kNone, 0});
    const auto readStates = [&] { parts_.states.read(states.data(), 0, count * sizeof states[0]); };
    if (basis_.known) readStates();
    while (const std::optional<Round> round = nextRound(part, states)) {
      writeRound(*round);
      bool goesOn = false;
      do {
        paint(goesOn, count);
        readStates();
        goesOn = true;
      } while (std::any_of(states.begin(), states.end(),
                           [](const LineState& state) { return state.isStopped(); }));
    }
    takeEnds(part);
    bool again = false;
    std::vector<std::size_t> onCpu;
    for (std::size_t i = 0; i < count; ++i) {
      const std::size_t line = lineOf(part, i);
      const bool overflows = states[i].pieces == GlReplayParts::kOverflow;
      if (overflows && room_ < kMostReplayPieces) {
        asked_[line] = nextTurn;
        again = true;
      } else if (overflows || hasLongStart(line)) {
        onCpu.push_back(i);
      }
    }
    replayOnCpu(part, onCpu);
    return again;
  }
  [[nodiscard]] bool hasLongStart(std::size_t line) const {
    return basis_.start && basis_.start->endCount(line) > kMostReplayPieces / 2;
  }

  // Lines with more pieces or ends than the card is given.
  void replayOnCpu(const Part& part, std::span<const std::size_t> which) {
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
    for (std::size_t w = 0; w < which.size(); ++w) out_->write(lineOf(part, which[w]), ends[w]);
  }

  [[nodiscard]] std::size_t lineOf(const Part& part, std::size_t i) const {
    return out_->lineAt(static_cast<int>(part.lines[i][0]), static_cast<int>(part.lines[i][1]));
  }
  [[nodiscard]] CutLine cutLine(const Part& part, std::size_t i) const {
    const Four& line = part.lines[i];
    return {lines_.family.line(static_cast<int>(line[0]), static_cast<int>(line[1])),
            std::bit_cast<float>(line[2]), std::bit_cast<float>(line[3])};
  }

  void useOnLines(const GlProgram& program) const {
    program.use();
    if (const int at = program.at("family"); at >= 0) glUniform3dv(at, 6, family_.data());
    if (const int at = program.at("room"); at >= 0) glUniform1ui(at, static_cast<GLuint>(room_));
  }

  // Lines as they are before any step.
  void start(const Part& part) {
    useOnLines(parts_.start);
    glUniform1ui(parts_.start.at("hasKnown"), basis_.known ? 1 : 0);
    const Words known = basis_.known ? knownOf(part) : Words();
    parts_.before.write(known.data(), known.size() * sizeof known[0]);
    parts_.lines.bind(0);
    parts_.pieces.bind(1);
    parts_.states.bind(2);
    parts_.before.bind(3);
    GlDexelContext::State::runOnLines(parts_.start, part.lines.size());
  }

  // Of each line where its pieces are and how many, then pieces. Several lines share a row of cells: what
  // cells know of one of them they know of all.
  [[nodiscard]] Words knownOf(const Part& part) const {
    struct OfTile {
      Words pieces;
      std::vector<std::array<std::uint32_t, 2>> places;
    };
    std::vector<OfTile> tiles(part.tiles.size());
    inArena(execution_, [&] {
      tbb::parallel_for(std::size_t{0}, tiles.size(), [&](std::size_t t) {
        const Part::Tile& tile = part.tiles[t];
        OfTile& of = tiles[t];
        LinePainter painter;
        std::vector<std::optional<std::array<int, 3>>> rows;
        for (std::uint32_t i = tile.firstLine; i < tile.endLine; ++i) {
          const CutLine line = cutLine(part, i);
          rows.push_back(basis_.known->rowOf(line.ray));
          const Four& own = part.lines[i];
          const std::size_t k = i - tile.firstLine;
          std::size_t like = rows[k] ? 0 : k;
          while (like < k && !(rows[like] == rows[k] && part.lines[tile.firstLine + like][2] == own[2] &&
                               part.lines[tile.firstLine + like][3] == own[3]))
            ++like;
          if (like < k) {
            of.places.push_back(of.places[like]);
            continue;
          }
          startLine(painter, line, basis_.known);
          of.places.push_back({static_cast<std::uint32_t>(of.pieces.size()),
                               static_cast<std::uint32_t>(painter.pieces().size())});
          for (const LinePainter::Piece& piece : painter.pieces()) {
            of.pieces.push_back(std::bit_cast<std::uint32_t>(piece.begin));
            of.pieces.push_back(piece.owner);
          }
        }
      });
    });
    Words all;
    std::size_t base = 2 * part.lines.size();
    for (const OfTile& of : tiles) {
      for (const auto& [at, count] : of.places) {
        all.push_back(static_cast<std::uint32_t>(base) + at);
        all.push_back(count);
      }
      base += of.pieces.size();
    }
    for (const OfTile& of : tiles) all.insert(all.end(), of.pieces.begin(), of.pieces.end());
    return all;
  }

  // A step of a tile that the card does not know: its stretches on the tile's lines.
  struct Job {
    const Part::Tile* tile;
    std::uint32_t step;
    Words table;  // for each line, and behind the last one, where its stretches begin; stretches
  };
  [[nodiscard]] bool isTabled(std::uint32_t step) const {
    return !steps_[step].ball || steps_[step].operation == DexelOperation::Intersection;
  }

  // Nothing: no line that is undecided has steps left.
  [[nodiscard]] std::optional<Round> nextRound(Part& part, std::span<const LineState> states) {
    constexpr std::size_t kItems = 4096, kJobs = std::size_t{1} << 14;
    std::vector<std::size_t> stops(part.tiles.size(), 0);  // of lists; 0: nothing in this round
    std::vector<Job> jobs;
    bool some = false;
    for (std::size_t t = 0; t < part.tiles.size(); ++t) {
      Part::Tile& tile = part.tiles[t];
      const std::span<const std::uint32_t> list = here_->of(tile.tile);
      if (tile.next == list.size()) continue;
      const auto lines = states.subspan(tile.firstLine, tile.endLine - tile.firstLine);
      if (std::all_of(lines.begin(), lines.end(), [](const LineState& state) { return state.isDecided(); })) {
        tile.next = list.size();
        continue;
      }
      if (jobs.size() >= kJobs) continue;
      std::size_t stop = tile.next;
      for (std::size_t tabled = 0; stop < list.size() && stop - tile.next < kItems; ++stop)
        if (isTabled(list[stop])) {
          if (tabled++ == options_.solids) break;
          jobs.push_back({&tile, list[stop], {}});
        }
      stops[t] = stop;
      some = true;
    }
    if (!some) return std::nullopt;
    inArena(execution_, [&] {
      tbb::parallel_for(std::size_t{0}, jobs.size(),
                        [&](std::size_t j) { makeTable(part, states, jobs[j]); });
    });
    return roundOf(part, stops, jobs);
  }

  void makeTable(const Part& part, std::span<const LineState> states, Job& job) {
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
  [[nodiscard]] Round roundOf(Part& part, std::span<const std::size_t> stops,
                              std::span<const Job> jobs) const {
    const std::size_t most = state_.largestBlock() / sizeof(std::uint32_t);
    Round round;
    std::size_t job = 0;
    for (std::size_t t = 0; t < part.tiles.size(); ++t) {
      Part::Tile& tile = part.tiles[t];
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
          round.items.push_back(step | GlReplayParts::kTabled);
          append(jobs[job++].table, tile, round);
        }
      }
      job = endJob;
      round.tiles.push_back({from, static_cast<std::uint32_t>(round.items.size()), tile.firstLine, 0});
    }
    return round;
  }
  static void append(const Words& table, const Part::Tile& tile, Round& round) {
    const auto base = static_cast<std::uint32_t>(round.table.size());
    round.items.push_back(base);
    const std::size_t offsets = tile.endLine - tile.firstLine + 1;
    for (std::size_t k = 0; k < table.size(); ++k) round.table.push_back(table[k] + (k < offsets ? base : 0));
  }

  void writeRound(const Round& round) {
    parts_.tiles.write(round.tiles.data(), round.tiles.size() * sizeof round.tiles[0]);
    parts_.items.write(round.items.data(), round.items.size() * sizeof round.items[0]);
    parts_.table.write(round.table.data(), round.table.size() * sizeof round.table[0]);
  }
  void paint(bool goesOn, std::size_t count) {
    useOnLines(parts_.paint);
    glUniform1ui(parts_.paint.at("goesOn"), goesOn ? 1 : 0);
    parts_.lines.bind(0);
    parts_.pieces.bind(1);
    parts_.states.bind(2);
    parts_.lineTiles.bind(3);
    parts_.tiles.bind(4);
    parts_.items.bind(5);
    parts_.table.bind(6);
    parts_.balls.bind(7);
    GlDexelContext::State::runOnLines(parts_.paint, count);
  }

  // What lines held before any step: of each where its ends are and how many, then depths and normals.
  [[nodiscard]] Words startOf(const Part& part) const {
    Words places, all;
    LineEnds ends;
    for (std::size_t i = 0; i < part.lines.size(); ++i) {
      ends.clear();
      if (const std::size_t line = lineOf(part, i); !hasLongStart(line)) basis_.start->read(line, ends);
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

  void takeEnds(const Part& part) {
    const std::size_t count = part.lines.size();
    GlDexelContext::State::Scratch& scratch = state_.scratch();
    const Words start = basis_.start ? startOf(part) : Words();
    parts_.before.write(start.data(), start.size() * sizeof start[0]);
    scratch.offsets.reserve((count + 1) * sizeof(std::uint32_t));
    scratch.groupSums.reserve(((count + 255) / 256 + 1) * sizeof(std::uint32_t));
    for (const GlProgram* program : {&parts_.countEnds, &parts_.writeEnds}) {
      useOnLines(*program);
      glUniform1ui(program->at("hasStart"), basis_.start ? 1 : 0);
      parts_.lines.bind(0);
      parts_.pieces.bind(1);
      parts_.states.bind(2);
      parts_.before.bind(3);
      scratch.offsets.bind(4);
      scratch.groupSums.bind(5);
      parts_.balls.bind(7);
      if (program == &parts_.writeEnds) {
        state_.scanGroups(count);
        scratch.ends.reserve(state_.countedOf(count) * sizeof(SpanEnd));
        scratch.ends.bind(6);
      }
      GlDexelContext::State::runOnLines(*program, count);
    }
    Words offsets(count + 1);
    scratch.offsets.read(offsets.data(), 0, offsets.size() * sizeof offsets[0]);
    LineEnds ends(offsets.back());
    scratch.ends.read(ends.data(), 0, ends.size() * sizeof ends[0]);
    writeLines(part, offsets, ends);
  }

  // Row of tiles by row, as dexels may be changed.
  void writeLines(const Part& part, const Words& offsets, LineEnds& ends) {
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
          out_->write(lineOf(part, i), own);
        }
      });
    });
  }

  // The card's owners become operations, and normals that it could not tell are found.
  void complete(const Part& part, std::size_t line, std::span<SpanEnd> ends) {
    StepsOnLine& onLine = onLine_->local();
    for (std::size_t k = 0; k < ends.size(); ++k) {
      SpanEnd& end = ends[k];
      const auto inner = static_cast<std::uint32_t>(end.inner), outer = static_cast<std::uint32_t>(end.outer);
      const bool begins = k % 2 == 0;
      if (end.isCut()) {
        const std::uint32_t later = inner + 1 > outer + 1 ? inner : outer;
        if ((end.normal & GlReplayParts::kAsk) != 0)
          end.normal = onLine.normalAt({end.depth, begins ? outer : inner, begins ? inner : outer, begins},
                                       cutLine(part, line).ray);
        else if (onLine.idOf(later) == OperationId::Initial)
          end.normal &= ~kPackedFlag;
      }
      end.inner = onLine.idOf(inner);
      end.outer = onLine.idOf(outer);
    }
  }

  GlDexelContext::State& state_;
  GlReplayParts& parts_;
  const GlLineReplay::Options& options_;
  const LinesInZone& lines_;
  ReplayBasis basis_;
  Execution execution_;
  Dexels* out_ = nullptr;
  std::vector<double> family_;
  std::vector<std::uint8_t> asked_;  // of each line whose turn it is; 0: it is done, or not in the zone
  std::size_t room_ = 0;

  // Of the rectangle at hand.
  StepsOfTiles* here_ = nullptr;
  std::vector<HistoryStep> steps_;
  std::optional<tbb::enumerable_thread_specific<StepsOnLine>> onLine_;
};

}  // namespace

Dexels GlLineReplay::operator()(const DexelHistory& history, std::span<const OperationId> ids,
                                const LinesInZone& lines, const Execution& execution,
                                const ReplayBasis& basis) const {
  RESTROKE_CHECK_EQ(options_.room > 0 && options_.lines > 0 && options_.solids > 0, true);
  Dexels out(lines.family.width, lines.family.height, {.operations = true});
  RESTROKE_CHECK_EQ(out.lineCount(), lines.from.size());
  const std::vector<HistoryStep> steps = stepsOf(history, ids);
  GlDexelContext::State& state = *context_.state();
  const GlDexelContext::State::Use use(state);
  Replay(state, options_, lines, basis).run(steps, execution, out);
  checkGlErrors("these lines");
  return out;
}

}  // namespace restroke::points
