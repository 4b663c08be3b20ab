# What OpenEXR would look for and fetch by itself: meson.build beside this passes and links it.
foreach(target ZLIB::ZLIB Imath::Imath Imath::ImathConfig)
  if(NOT TARGET ${target})
    add_library(${target} INTERFACE IMPORTED GLOBAL)
  endif()
endforeach()
