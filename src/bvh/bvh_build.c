typedef int bvh_build_placeholder;
