// Lines are worked on in parts, and a part in rounds: each takes the next steps of every tile that has
// undecided lines. When all lines are decided, or steps are done, their ends are counted, summed up, written,
// and brought back.

#include "points/dexel/gl/gl_line_replay.h"

#include <epoxy/gl.h>

#include <algorithm>
#include <bit>
#include <limits>
#include <memory>
#include <optional>
#include <utility>

#include "implicit/errors.h"
#include "points/dexel/gl/gl_dexel_shaders.h"
#include "points/dexel/gl/gl_dexel_state.h"
#include "points/dexel/gl/gl_line_replay_shaders.h"
#include "points/dexel/gl/gl_replay_work.h"

namespace restroke::points {

namespace {

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

constexpr std::size_t kBytesPerPiece = 16;

class Replay {
 public:
  Replay(GlDexelContext::State& state, const GlLineReplay::Options& options, const LineFamily& family,
         const ReplayBasis& basis)
      : state_(state), parts_(state.replayParts()), options_(options), basis_(basis) {
    const DVec3 vectors[] = {family.origin,    family.originStep,    family.originRowStep,
                             family.direction, family.directionStep, family.directionRowStep};
    for (const DVec3& v : vectors)
      for (int a = 0; a < 3; ++a) family_.push_back(v[a]);
  }

  /// Lines and basis are the work's.
  void run(ReplayWork& work, std::span<const HistoryStep> steps, std::span<const PlacedStep> placed,
           const LineRectangle& tiles) {
    StepsOfTiles here(placed, tiles);
    if (here.tileCount() == 0 || (here.steps().empty() && !basis_.start && !basis_.known)) return;
    if (here.tileCount() > 1 && (here.pairCount() > options_.pairs ||
                                 here.steps().size() > state_.largestBlock() / sizeof(FourWords))) {
      LineRectangle first = tiles, second = tiles;
      if (tiles.endRow - tiles.firstRow > 1)
        first.endRow = second.firstRow = (tiles.firstRow + tiles.endRow) / 2;
      else
        first.endColumn = second.firstColumn = (tiles.firstColumn + tiles.endColumn) / 2;
      run(work, steps, here.steps(), first);
      run(work, steps, here.steps(), second);
      return;
    }
    work.take(std::move(here), steps);
    writeBalls(work);
    replayLines(work);
  }

 private:
  // Turn after turn, with more and more room.
  void replayLines(ReplayWork& work) {
    // So many pieces of all lines are seen at once; what is known of them before may be as much.
    const std::size_t pieces = state_.largestBlock() / kBytesPerPiece;
    room_ = std::min<std::size_t>(options_.room, kMostReplayPieces);
    bool again = true;
    for (std::uint8_t turn = 1; again; ++turn) {
      again = false;
      const std::size_t room = basis_.known || basis_.start ? std::max<std::size_t>(room_, 64) : room_ + 1;
      const std::size_t most = std::clamp<std::size_t>(pieces / room, 1, options_.lines);
      std::size_t tile = 0;
      for (;;) {
        ReplayPart part = work.nextPart(tile, turn, most);
        if (part.lines.empty()) break;
        again = replayPart(work, part, static_cast<std::uint8_t>(turn + 1)) || again;
      }
      room_ = std::min<std::size_t>(8 * room_, kMostReplayPieces);
    }
  }

  void writeBalls(const ReplayWork& work) {
    std::vector<FourWords> balls;
    balls.reserve(work.steps().size());
    for (std::uint32_t i = 0; i < work.steps().size(); ++i) {
      const HistoryStep& step = work.steps()[i];
      const bool fills = step.operation == DexelOperation::Union;
      implicit::Sphere ball{Point(0), std::numeric_limits<float>::infinity()};
      if (!work.isTabled(i)) ball = *step.ball;
      const auto bits = [](float x) { return std::bit_cast<std::uint32_t>(x); };
      balls.push_back({bits(ball.center.x), bits(ball.center.y), bits(ball.center.z),
                       bits(fills ? ball.radius : -ball.radius)});
    }
    parts_.balls.write(balls.data(), balls.size() * sizeof balls[0]);
  }

  // True: some lines have more pieces than there is room for; their turn is the one that is told.
  bool replayPart(ReplayWork& work, ReplayPart& part, std::uint8_t nextTurn) {
    const std::size_t count = part.lines.size();
    parts_.lines.write(part.lines.data(), count * sizeof part.lines[0]);
    parts_.lineTiles.write(part.lineTiles.data(), count * sizeof part.lineTiles[0]);
    parts_.pieces.reserve(count * room_ * kBytesPerPiece);
    parts_.states.reserve(count * sizeof(ReplayLineState));
    start(part, basis_.known ? work.knownOf(part) : ReplayWords());
    std::vector<ReplayLineState> states(count);
    const auto readStates = [&] { parts_.states.read(states.data(), 0, count * sizeof states[0]); };
    if (basis_.known) readStates();
    while (const std::optional<ReplayRound> round = work.nextRound(part, states)) {
      writeRound(*round);
      bool goesOn = false;
      do {
        paint(goesOn, count);
        readStates();
        goesOn = true;
      } while (std::any_of(states.begin(), states.end(),
                           [](const ReplayLineState& state) { return state.isStopped(); }));
    }
    takeEnds(work, part);
    bool again = false;
    std::vector<std::size_t> onCpu;
    for (std::size_t i = 0; i < count; ++i) {
      const bool overflows = states[i].pieces == kReplayOverflow;
      if (overflows && room_ < kMostReplayPieces) {
        work.askAgain(part, i, nextTurn);
        again = true;
      } else if (overflows || work.hasLongStart(part, i)) {
        onCpu.push_back(i);
      }
    }
    work.replayOnCpu(part, onCpu);
    return again;
  }

  void useOnLines(const GlProgram& program) const {
    program.use();
    if (const int at = program.at("family"); at >= 0) glUniform3dv(at, 6, family_.data());
    if (const int at = program.at("room"); at >= 0) glUniform1ui(at, static_cast<GLuint>(room_));
  }

  // Lines as they are before any step.
  void start(const ReplayPart& part, const ReplayWords& known) {
    useOnLines(parts_.start);
    glUniform1ui(parts_.start.at("hasKnown"), basis_.known ? 1 : 0);
    parts_.before.write(known.data(), known.size() * sizeof known[0]);
    parts_.lines.bind(0);
    parts_.pieces.bind(1);
    parts_.states.bind(2);
    parts_.before.bind(3);
    GlDexelContext::State::runOnLines(parts_.start, part.lines.size());
  }

  void writeRound(const ReplayRound& round) {
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

  // Ends are counted, written, and taken back.
  void takeEnds(ReplayWork& work, const ReplayPart& part) {
    const std::size_t count = part.lines.size();
    GlDexelContext::State::Scratch& scratch = state_.scratch();
    const ReplayWords start = basis_.start ? work.startOf(part) : ReplayWords();
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
    ReplayWords offsets(count + 1);
    scratch.offsets.read(offsets.data(), 0, offsets.size() * sizeof offsets[0]);
    LineEnds ends(offsets.back());
    scratch.ends.read(ends.data(), 0, ends.size() * sizeof ends[0]);
    work.writeLines(part, offsets, ends);
  }

  GlDexelContext::State& state_;
  GlReplayParts& parts_;
  const GlLineReplay::Options& options_;
  const ReplayBasis& basis_;
  std::vector<double> family_;
  std::size_t room_ = 0;
};

}  // namespace

Dexels GlLineReplay::operator()(const ReplayInput& input, const LinesInZone& lines,
                                const Execution& execution) const {
  RESTROKE_CHECK_EQ(options_.room > 0 && options_.lines > 0 && options_.solids > 0, true);
  Dexels out(lines.family.width, lines.family.height, {.operations = true});
  RESTROKE_CHECK_EQ(out.lineCount(), lines.from.size());
  const std::vector<HistoryStep> steps = stepsOf(input.history, input.ids);
  GlDexelContext::State& state = *context_.state();
  const GlDexelContext::State::Use use(state);
  const ReplayWork::Limits limits{options_.solids, state.largestBlock() / sizeof(std::uint32_t)};
  ReplayWork work({lines, input.basis, execution, out}, limits);
  Replay(state, options_, lines.family, input.basis)
      .run(work, steps, placedSteps(steps, lines.family), tilesOf({0, out.width(), 0, out.height()}));
  checkGlErrors("these lines");
  return out;
}

}  // namespace restroke::points
