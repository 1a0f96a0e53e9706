#include "retarget/alignment/nearest.h"

#include <flann/flann.hpp>

namespace restroke::retarget::alignment {

namespace {

constexpr std::size_t kDimensions = 6;

void addFeatures(const Sample& s, double normalWeight, std::vector<float>& features) {
  for (int a = 0; a < 3; ++a) features.push_back(static_cast<float>(s.position[a]));
  for (int a = 0; a < 3; ++a) features.push_back(static_cast<float>(normalWeight * s.normal[a]));
}

std::vector<float> featuresOf(std::span<const Sample> samples, double normalWeight) {
  std::vector<float> features;
  features.reserve(samples.size() * kDimensions);
  for (const Sample& s : samples) addFeatures(s, normalWeight, features);
  return features;
}

}  // namespace

struct NearestSamples::Tree {
  Tree(std::span<const Sample> samples, double weight)
      : normalWeight(weight),
        features(featuresOf(samples, weight)),
        index(flann::Matrix<float>(features.data(), samples.size(), kDimensions),
              flann::KDTreeSingleIndexParams(10)) {
    index.buildIndex();
  }
  double normalWeight;
  std::vector<float> features;
  flann::KDTreeSingleIndex<flann::L2_Simple<float>> index;
};

NearestSamples::NearestSamples(std::span<const Sample> samples, double normalWeight)
    : tree_(std::make_unique<Tree>(samples, normalWeight)) {}
NearestSamples::~NearestSamples() = default;
NearestSamples::NearestSamples(NearestSamples&&) noexcept = default;
NearestSamples& NearestSamples::operator=(NearestSamples&&) noexcept = default;

void NearestSamples::find(std::span<const Sample> queries, float slack, Answer& answer) const {
  std::vector<float> features = featuresOf(queries, tree_->normalWeight);
  answer.index.resize(queries.size());
  answer.squaredDistance.resize(queries.size());
  if (queries.empty()) return;
  const flann::Matrix<float> asked(features.data(), queries.size(), kDimensions);
  flann::Matrix<std::size_t> indices(answer.index.data(), queries.size(), 1);
  flann::Matrix<float> distances(answer.squaredDistance.data(), queries.size(), 1);
  flann::SearchParams parameters(flann::FLANN_CHECKS_UNLIMITED, slack, false);
  parameters.use_heap = flann::FLANN_False;
  tree_->index.knnSearch(asked, indices, distances, 1, parameters);
}

}  // namespace restroke::retarget::alignment
