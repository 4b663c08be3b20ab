typedef int hash_placeholder;
