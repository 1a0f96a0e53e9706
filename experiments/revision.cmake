# Run at every build: writes ${OUT} with the revision of the sources in ${SOURCE}, and touches it only when that changes.
cmake_minimum_required(VERSION 3.25...3.31)
set(revision "unknown")
set(dirty "false")
find_program(GIT git)
if(GIT)
  execute_process(COMMAND "${GIT}" -C "${SOURCE}" rev-parse --short=12 HEAD OUTPUT_VARIABLE head
                  OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET RESULT_VARIABLE failed)
  if(NOT failed)
    set(revision "${head}")
    execute_process(COMMAND "${GIT}" -C "${SOURCE}" status --porcelain --untracked-files=no OUTPUT_VARIABLE changes
                    ERROR_QUIET)
    if(changes)
      set(dirty "true")
    endif()
  endif()
endif()
file(CONFIGURE OUTPUT "${OUT}" CONTENT
"#define RESTROKE_REVISION \"@revision@\"
#define RESTROKE_DIRTY @dirty@
#define RESTROKE_COMPILER \"@COMPILER@\"
#define RESTROKE_COMPILE_FLAGS \"@FLAGS@\"
" @ONLY)
