#include "experiments/figures.h"

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>

#include "experiments/shipped.h"
#include "implicit/errors.h"

extern char** environ;

namespace restroke::experiments {
namespace {

// Debian's matplotlib belongs to the system's Python, which need not be the first one on the path.
constexpr const char* kPython = "/usr/bin/python3";

struct Outcome {
  int status = 0;    // as from wait
  std::string said;  // on standard error
};

/// Runs a program to its end and collects what it says on standard error.
Outcome runToEnd(const std::vector<std::string>& command) {
  std::array<int, 2> pipe{};
  if (pipe2(pipe.data(), O_CLOEXEC) != 0)
    throw InputError(fmt::format("figures: no pipe for {} ({})", command[0], std::strerror(errno)));
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  // Standard output may carry the caller's JSON: the script may not write there.
  posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
  posix_spawn_file_actions_adddup2(&actions, pipe[1], STDERR_FILENO);
  std::vector<char*> argv;
  for (const std::string& word : command) argv.push_back(const_cast<char*>(word.c_str()));
  argv.push_back(nullptr);
  pid_t child = 0;
  const int error = posix_spawn(&child, command[0].c_str(), &actions, nullptr, argv.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  close(pipe[1]);
  Outcome outcome;
  if (error == 0) {
    std::array<char, 4096> block{};
    for (ssize_t n = 0; (n = read(pipe[0], block.data(), block.size())) != 0;) {
      if (n < 0 && errno == EINTR) continue;
      if (n < 0) break;
      outcome.said.append(block.data(), static_cast<std::size_t>(n));
    }
    while (waitpid(child, &outcome.status, 0) < 0 && errno == EINTR) {
    }
  }
  close(pipe[0]);
  if (error != 0)
    throw InputError(fmt::format("figures: {} cannot be started ({}); package python3 has it", command[0],
                                 std::strerror(error)));
  return outcome;
}

}  // namespace

void drawFigure(const std::string& script, const std::vector<std::string>& arguments) {
  // -B: what the scripts share is imported without leaving anything behind among the sources.
  const std::string file = shippedFile("plots/" + script).string();
  std::vector<std::string> command = {kPython, "-B", file};
  command.insert(command.end(), arguments.begin(), arguments.end());
  Outcome outcome = runToEnd(command);
  if (WIFEXITED(outcome.status) && WEXITSTATUS(outcome.status) == 0) return;
  while (!outcome.said.empty() && outcome.said.back() == '\n') outcome.said.pop_back();
  const std::string last = outcome.said.substr(outcome.said.rfind('\n') + 1);
  throw InputError(fmt::format("figures: {} failed ({}); it needs python3 with matplotlib", file,
                               last.empty() ? "no reason given" : last));
}

}  // namespace restroke::experiments
