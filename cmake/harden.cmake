# What makes an error of memory harder to exploit: docs/measured/reliability.md, "Flags". Not for builds with a sanitizer, which find such
# errors themselves, nor without optimization, where the C library cannot check sizes.
option(BRIO_HARDEN "Compile and link with checks against exploits of memory errors" OFF)

if(BRIO_HARDEN AND NOT BRIO_SANITIZE AND NOT BRIO_FUZZ AND NOT BRIO_THREADS_SANITIZED
   AND NOT CMAKE_BUILD_TYPE STREQUAL "Debug")
  include(CheckCCompilerFlag)
  include(CheckLinkerFlag)
  include(CheckPIESupported)
  check_pie_supported(OUTPUT_VARIABLE BRIO_PIE_SAID LANGUAGES C) # programs at any address
  foreach(flag -fstack-protector-strong -fstack-clash-protection -fcf-protection)
    string(MAKE_C_IDENTIFIER "BRIO_TAKES${flag}" takes)
    check_c_compiler_flag(-Werror\;${flag} ${takes})
    if(${takes})
      add_compile_options(${flag})
    endif()
  endforeach()
  if(NOT CMAKE_C_FLAGS MATCHES "_FORTIFY_SOURCE") # a distribution's own level stays
    add_compile_options(-U_FORTIFY_SOURCE -D_FORTIFY_SOURCE=2)
  endif()
  foreach(flag relro now)
    check_linker_flag(C -Wl,-z,${flag} BRIO_LINKS_${flag})
    if(BRIO_LINKS_${flag})
      add_link_options(-Wl,-z,${flag})
    endif()
  endforeach()
endif()
