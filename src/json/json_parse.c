#include "json/json_parse.h"

#include "base/memory.h"
#include <assert.h>
#include <setjmp.h>

// jansson 2.14 does not handle failed allocations correctly while it parses. If its buffer for a
// string cannot grow, it continues without the rest of the string and then writes past the end of
// the allocated memory. So a failed allocation leaves the parser at once, by longjmp, and the
// parser's allocations so far are freed here. For this, every block is in a list until the parse
// has ended.
struct block {
    struct block *previous, *next; // NULL: not allocated by a parse
};

struct parse {
    struct block blocks; // sentinel of the list
    jmp_buf on_failure;
};

_Static_assert(sizeof(struct block) % 16 == 0, "what follows is aligned as malloc's memory is");

static _Thread_local struct parse *current; // the parse that runs in this thread; NULL: none
static _Thread_local bool lost;             // see json_lost_memory()

void *json_allocate(size_t bytes)
{
    struct block *block = memory_alloc(sizeof *block + bytes);
    if (!block) {
        if (current)
            longjmp(current->on_failure, 1);
        lost = true;
        return NULL;
    }
    if (current) {
        struct block *first = current->blocks.next;
        *block = (struct block){&current->blocks, first};
        current->blocks.next = first->previous = block;
    }
    return block + 1;
}

void json_deallocate(void *data)
{
    if (!data)
        return;
    struct block *block = (struct block *)data - 1;
    if (block->next) {
        block->previous->next = block->next;
        block->next->previous = block->previous;
    }
    memory_free(block);
}

// Removes all blocks from the list, and frees them if the parse has failed.
static void parse_end(struct parse *parse, bool is_failed)
{
    for (struct block *block = parse->blocks.next; block != &parse->blocks;) {
        struct block *next = block->next;
        *block = (struct block){0};
        if (is_failed)
            memory_free(block);
        block = next;
    }
    current = NULL;
}

bool json_lost_memory(void)
{
    bool was_lost = lost;
    lost = false;
    return was_lost;
}

json_t *json_parse(const char *path, const struct file_bytes *text, size_t flags, struct err *err)
{
    struct parse parse = {.blocks = {&parse.blocks, &parse.blocks}};
    json_error_t problem;
    assert(!current);
    if (setjmp(parse.on_failure)) {
        parse_end(&parse, true);
        err_memory(err, "the JSON document", text->size);
        err_prepend(err, "%s", path);
        return NULL;
    }
    current = &parse;
    json_t *root = json_loadb((const char *)text->data, text->size, flags, &problem);
    parse_end(&parse, false);
    if (!root) {
        err_set(err, ERR_INPUT, "%s: line %d, column %d: %s", path, problem.line, problem.column,
                problem.text);
        err_locate(err, path, "");
    }
    return root;
}

void json_release(char *dumped)
{
    json_free_t free_function;
    json_get_alloc_funcs(NULL, &free_function);
    free_function(dumped);
}
