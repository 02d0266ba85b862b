# SPDX-License-Identifier: MIT
#
# cmake -DGIT=... -DSOURCE=... -DVERSION=... -DOUT=... -P stamp.cmake: writes OUT if it would change. The hash
# carries a + where tracked files differ from the commit.
set(hash unknown)
if(GIT AND EXISTS ${SOURCE}/.git)
  set(git ${GIT} -c safe.directory=* -C ${SOURCE})
  execute_process(COMMAND ${git} rev-parse --short=8 HEAD OUTPUT_VARIABLE found RESULT_VARIABLE failed
    OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
  if(NOT failed)
    set(hash ${found})
    execute_process(COMMAND ${git} diff --quiet HEAD -- RESULT_VARIABLE differs OUTPUT_QUIET ERROR_QUIET)
    if(differs)
      string(APPEND hash +)
    endif()
  endif()
endif()

set(text "#define CF_VERSION \"${VERSION}\"\n#define CF_GIT_HASH \"${hash}\"\n")
set(old "")
if(EXISTS ${OUT})
  file(READ ${OUT} old)
endif()
if(NOT text STREQUAL old)
  file(WRITE ${OUT} ${text})
endif()
