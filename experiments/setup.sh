# shellcheck shell=bash disable=SC2034
# What experiments/run, tests/run and .ci/run share: the list of packages, their installation, configuring, building.
# Sourced by bash; not a program. Nothing here needs root when nothing is missing.

restroke_root="$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd -P)"
restroke_started=$SECONDS

# Packages of Debian 12 and of Debian 13 (the names are the same). This is the only list of them.
restroke_packages=(
  g++ cmake ninja-build pkgconf                                # tools
  libtbb-dev libembree-dev libglm-dev libfmt-dev               # implicit, retarget
  libcgal-dev                                                  # implicit: exact predicates
  libepoxy-dev libegl-dev libegl1 libgl1-mesa-dri              # points: OpenGL without a display
  libqhull-dev                                                 # implicit: hulls
  libflann-dev liblz4-dev libceres-dev libeigen3-dev           # retarget: nearest surfels, alignment
  libimath-dev libopenexr-dev libpng-dev                       # points: images
  lib3mf-dev libpugixml-dev zlib1g-dev                         # points: mesh files
  libcli11-dev nlohmann-json3-dev libzstd-dev libxxhash-dev    # sculpt, experiments
  python3 python3-matplotlib python3-numpy                     # experiments: figures
  libgtest-dev libbenchmark-dev                                # tests
  admesh                                                       # tests: another opinion about meshes
  libopenvdb-dev libboost-iostreams-dev                        # tests/bench: a rival
  valgrind                                                     # tests/bench: counts of instructions
)
restroke_clang_packages=(clang-19 libclang-rt-19-dev)
restroke_ci_packages=(clang-format-19 openexr)

# heading TEXT: the line that opens a step. The step before it is closed with the time that it took.
heading() {
  end_step
  restroke_step="$1"
  restroke_step_started=$SECONDS
  restroke_step_busy=$(processor_seconds)
  printf '\n== %s\n' "$1"
}

# end_step: closes the step with its time, and with that of the processors, which says more where others use the machine too.
end_step() {
  if [[ -n "${restroke_step:-}" ]]; then
    printf '   %s: %d s (%d s of processor time)\n' "$restroke_step" "$((SECONDS - restroke_step_started))" \
      "$(($(processor_seconds) - restroke_step_busy))"
    restroke_step=""
  fi
}

# processor_seconds: what this script and all that it has waited for have used.
processor_seconds() {
  local stat fields
  read -r stat </proc/$$/stat
  read -ra fields <<<"${stat##*) }" # user, system, and the same of children: 14 to 17 in proc(5), and two stand before ")"
  printf '%s\n' "$(((fields[11] + fields[12] + fields[13] + fields[14]) / $(getconf CLK_TCK)))"
}

# complain TEXT...: one sentence on standard error.
complain() { printf '%s: %s\n' "${restroke_name:-$0}" "$*" >&2; }

# missing_packages NAME...: prints those that are not installed.
missing_packages() {
  local name state
  for name in "$@"; do
    state="$(dpkg-query -W -f '${db:Status-Status} ' "$name" 2>/dev/null || true)"
    [[ " $state" == *" installed "* ]] || printf '%s\n' "$name"
  done
}

# install_packages NAME...: installs what is missing, as root or through sudo; exits 2 where that cannot be done.
install_packages() {
  if ! command -v dpkg-query >/dev/null || ! command -v apt-get >/dev/null; then
    complain "this is not Debian (no dpkg-query, no apt-get): install the counterparts of: $*"
    exit 2
  fi
  local missing=()
  mapfile -t missing < <(missing_packages "$@")
  if ((${#missing[@]} == 0)); then
    printf '   nothing is missing\n'
    return
  fi

  local as_root=()
  if ((EUID != 0)); then
    if command -v sudo >/dev/null && sudo -n true 2>/dev/null; then
      as_root=(sudo)
    elif command -v sudo >/dev/null && [[ -t 0 && -t 2 ]] && sudo true; then
      as_root=(sudo)
    else
      complain "these packages are missing, and installing them needs root or sudo: ${missing[*]}"
      complain "ask someone who may for: apt-get install --no-install-recommends ${missing[*]}"
      exit 2
    fi
  fi
  printf '   installing: %s\n' "${missing[*]}"
  as_root+=(env DEBIAN_FRONTEND=noninteractive)
  # A source that cannot be reached must not stop an installation that does not need it.
  "${as_root[@]}" apt-get -o DPkg::Lock::Timeout=300 -qq update </dev/null ||
    complain "apt-get update failed; going on with the lists that are there"
  if ! "${as_root[@]}" apt-get -o DPkg::Lock::Timeout=300 -o Dpkg::Use-Pty=0 -qq install -y \
      --no-install-recommends "${missing[@]}" </dev/null; then
    complain "apt-get could not install: ${missing[*]}"
    exit 2
  fi
}

# build_jobs: as many as there are processors, and 1.5 GB of memory for each.
build_jobs() {
  local processors memory
  processors="$(nproc)"
  memory="$(awk '/^MemAvailable:/ { print int($2 / 1500000) }' /proc/meminfo 2>/dev/null || true)"
  [[ -n "$memory" ]] || memory="$processors"
  ((memory >= 1)) || memory=1
  printf '%s\n' "$((memory < processors ? memory : processors))"
}

# configure FOLDER CMAKE-ARGUMENT...: does nothing when the folder is configured already, in the same way, from the same
# sources, with the same compiler on the same system; begins anew when it is configured differently.
configure() {
  local folder="$1" stamp compiler
  shift
  if [[ -e "$folder" && ! -w "$folder" ]]; then
    complain "$folder is someone else's (made by root?): remove it, or make it yours with chown"
    return 1
  fi
  compiler="${CXX:-c++}"
  stamp="$(printf '%s\n' "$restroke_root" "$folder" "$@" "launcher ${CMAKE_CXX_COMPILER_LAUNCHER:-none}" \
    "flags ${CXXFLAGS:-} ${LDFLAGS:-}" "$("$compiler" --version 2>&1 | head -n 1)" "$(cmake --version | head -n 1)" \
    "$(sed -n 's/^PRETTY_NAME=//p' /etc/os-release 2>/dev/null)")"
  if [[ -f "$folder/build.ninja" && -f "$folder/.configured" && "$(<"$folder/.configured")" == "$stamp" ]]; then
    printf '   %s is configured already\n' "$folder"
    return
  fi
  mkdir -p "$folder"
  local fresh=()
  if [[ -f "$folder/CMakeCache.txt" ]]; then fresh=(--fresh); fi
  rm -f "$folder/.configured"
  cmake "${fresh[@]}" -S "$restroke_root" -B "$folder" -G Ninja "$@" >"$folder/configure.txt" 2>&1 || {
    cat "$folder/configure.txt" >&2
    complain "configuring $folder failed"
    return 1
  }
  # What another compiler left behind is not up to date, whatever its time stamps say.
  if ((${#fresh[@]})); then ninja -C "$folder" -t clean >/dev/null; fi
  printf '%s\n' "$stamp" >"$folder/.configured"
}

# build FOLDER TARGET...
build() {
  local folder="$1"
  shift
  ninja -C "$folder" -j "${RESTROKE_JOBS:-$(build_jobs)}" "$@"
}
