# SPDX-License-Identifier: MIT
# One value, PUNCTUM_SANITIZER, for every target alike.

if(PUNCTUM_SANITIZER)
  add_compile_options(-fsanitize=${PUNCTUM_SANITIZER} -fno-omit-frame-pointer -fno-sanitize-recover=all)
  add_link_options(-fsanitize=${PUNCTUM_SANITIZER})
endif()
