typedef int bvh_wide_placeholder;
