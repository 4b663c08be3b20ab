typedef int bvh_validate_placeholder;
