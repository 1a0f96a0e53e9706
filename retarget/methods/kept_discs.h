#pragma once
// Where the method "embree" leaves its scene between two strokes.

#include <memory>
#include <mutex>

namespace restroke::retarget {

class DiscScene;

/// Belongs to whoever casts one stroke after the other on a shape. A caster takes the scene, brings it up to
/// date and leaves it here when it goes, so that the next one has little to build. One that finds nothing, as
/// while another caster has it, starts with an empty scene. It is of no consequence which model the scene was
/// of (DiscScene). Safe to use from several threads; must outlive the casters that it is given to.
class KeptDiscs {
 public:
  KeptDiscs();
  ~KeptDiscs();
  KeptDiscs(const KeptDiscs&) = delete;
  KeptDiscs& operator=(const KeptDiscs&) = delete;

  /// Null when nothing is here.
  [[nodiscard]] std::unique_ptr<DiscScene> take();
  void giveBack(std::unique_ptr<DiscScene> scene);

 private:
  std::mutex mutex_;
  std::unique_ptr<DiscScene> scene_;
};

}  // namespace restroke::retarget
