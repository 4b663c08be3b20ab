typedef int load_json_placeholder;
