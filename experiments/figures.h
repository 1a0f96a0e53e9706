#pragma once
// Figures are drawn by matplotlib, from the CSV that the experiment has written.

#include <string>
#include <vector>

namespace restroke::experiments {

/// Runs experiments/plots/<script> with the system's Python. Throws InputError with one sentence when Python,
/// matplotlib or the script is missing or the script fails; what it wrote on standard error is part of the
/// sentence.
void drawFigure(const std::string& script, const std::vector<std::string>& arguments);

}  // namespace restroke::experiments
