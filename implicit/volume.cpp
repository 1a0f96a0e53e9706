#include "implicit/volume.h"

namespace restroke::implicit {

const SampleTable& Volume::samples(std::uint32_t count) const {
  const std::lock_guard lock(mutex_);
  for (const auto& [known, table] : tables_)
    if (known == count) return *table;
  tables_.emplace_back(count, std::make_unique<SampleTable>(makeSamples(count)));
  return *tables_.back().second;
}

std::size_t Volume::bytes() const {
  const std::lock_guard lock(mutex_);
  std::size_t bytes =
      sizeof(*this) + ownBytes() + bytesOf(parameters_) + tables_.capacity() * sizeof(tables_.front());
  for (const auto& [count, table] : tables_) bytes += table->bytes();
  return bytes;
}

}  // namespace restroke::implicit
