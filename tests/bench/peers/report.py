"""Makes plain values of the results, and tables in Markdown."""
import estimate


def _mean(values):
    return sum(values) / len(values)


def _renderer(comparison, renderer, costs):
    samples = comparison.options.spp * comparison.options.size**2
    result = {'renderer': renderer.name, 'version': renderer.version, 'turns': len(costs['relmse'])}
    for key in ('relmse', 'relmse_99', 'load'):
        result[key] = _mean(costs[key])
    result['rays'] = _mean(costs['rays']) or None  # Cycles does not count its rays
    for kind, speed in (('seconds', 'msamples_per_s'), ('processor_seconds', 'msamples_per_processor_s')):
        mean = _mean(costs[kind])
        known = mean > 0  # with few samples, the noise of other work may exceed their cost
        result[kind], result[kind + '_1'] = mean if known else None, costs[kind + '_1']
        result[speed] = samples / mean * 1e-6 if known else None
        result['relmse_' + kind] = result['relmse'] * mean if known else None
    mean, error = estimate.mean(comparison.references[renderer.family])
    result['mean'], result['mean_standard_error'] = mean, error
    return result


RATIOS = {'relmse': ('relmse',), 'relmse_99': ('relmse_99',), 'rays': ('rays',), 'relmse_rays': ('relmse', 'rays'),
          'processor_seconds': ('processor_seconds',), 'seconds': ('seconds',),
          'relmse_processor_seconds': ('relmse', 'processor_seconds'), 'relmse_seconds': ('relmse', 'seconds')}


def _against(comparison, ours, theirs, costs):
    """Compares two renderers: ratios as logarithms, and whether both solve the same problem."""
    a, b = costs[ours.name], costs[theirs.name]
    logarithms = {name: estimate.ratio([a[key] for key in keys], [b[key] for key in keys])
                  for name, keys in RATIOS.items()}
    pair = comparison.references[ours.family], comparison.references[theirs.family]
    result = {'of': ours.name, 'renderer': theirs.name, 'mean': estimate.ratio_of_means(*pair),
              'difference': estimate.difference(*pair)}
    if ours.family == theirs.family:
        result['mean'], result['difference'] = (1, 1, 1), 0  # both have the same references
    return result, logarithms


def _pairs(renderers):
    """Returns the pairs that are compared: the first renderer with each other one, and other builds of Lampyris with
    Cycles."""
    first, *others = renderers
    return [(first, other) for other in others] + [
        (other, cycles) for cycles in others if cycles.family != first.family
        for other in others if other.family == first.family]


def results(compared):
    """Returns the results of finished comparisons. Ratios are [estimate, low, high] with 95 %."""
    options = compared[0].options
    found = {'size': options.size, 'spp': options.spp, 'reference_spp': options.reference_spp, 'turns': options.turns,
             'max_bounces': compared[0].description['max_bounces'], 'scenes': [], 'geometric_means': {}}
    logarithms = {}
    for comparison in compared:
        costs = {renderer.name: comparison.costs(renderer) for renderer in comparison.renderers}
        scene = {'scene': comparison.key['scene'], 'identity': comparison.identity, 'ratios': [],
                 'renderers': [_renderer(comparison, one, costs[one.name]) for one in comparison.renderers]}
        for ours, theirs in _pairs(comparison.renderers):
            ratios, logs = _against(comparison, ours, theirs, costs)
            scene['ratios'].append(dict(ratios, **{name: log.interval() for name, log in logs.items()}))
            for name, log in logs.items():
                logarithms.setdefault('%s / %s' % (ours.name, theirs.name), {}).setdefault(name, []).append(log)
        found['scenes'].append(scene)
    for pair, by_name in logarithms.items():
        found['geometric_means'][pair] = {name: estimate.geometric_mean(logs).interval()
                                          for name, logs in by_name.items()}
    return found


# --- Tables --------------------------------------------------------------------------------------


def _number(value):
    return 'not known' if value is None else '%.3g' % value


def _interval(ratio):
    value, low, high = ratio
    if value is None:
        return 'not known'
    return '%.3g' % value if low is None else '%.3g [%.3g, %.3g]' % (value, low, high)


def _table(head, rows):
    return ['| ' + ' | '.join(head) + ' |', '|' + '---|' * len(head)] + \
        ['| ' + ' | '.join(row) + ' |' for row in rows]


def _renderers_table(found):
    head = ['scene', 'renderer', 'turns', 'Msamples/s', 'a processor s', 'relMSE', 'relMSE x s', 'processor s',
            'relMSE x processor s']
    keys = ('msamples_per_s', 'msamples_per_processor_s', 'relmse', 'relmse_seconds', 'processor_seconds',
            'relmse_processor_seconds')
    rows = []
    for scene in found['scenes']:
        for one in scene['renderers']:
            rows.append([scene['scene'], one['renderer'], str(one['turns']), *(_number(one[key]) for key in keys)])
    return _table(head, rows)


def _ratios_table(found):
    head = ['scene', 'ratio', 'relMSE', 'without the worst 1 %', 'rays', 'processor s', 'relMSE x rays',
            'relMSE x processor s', 'relMSE x s', 'mean radiance', 'relMSE between the means']
    names = ('relmse', 'relmse_99', 'rays', 'processor_seconds', 'relmse_rays', 'relmse_processor_seconds',
             'relmse_seconds')
    rows = []
    for scene in found['scenes']:
        for ratio in scene['ratios']:
            value, low, high = ratio['mean']
            rows.append([scene['scene'], '%s / %s' % (ratio['of'], ratio['renderer']),
                         *(_interval(ratio[name]) for name in names),
                         '%.4f [%.4f, %.4f]' % (value, low, high), '%.1e' % ratio['difference']])
    for pair, means in found['geometric_means'].items():
        rows.append(['geometric mean', pair, *(_interval(means[name]) for name in names), '', ''])
    return _table(head, rows)


def text(found):
    loads = [one['load'] for scene in found['scenes'] for one in scene['renderers']]
    versions = {one['renderer']: one['version'] for scene in found['scenes'] for one in scene['renderers']}
    lines = ['%d x %d pixels, %d samples per pixel, %d scattering events; two references of %d samples per pixel. The '
             'machine\'s load was %.1f to %.1f.' % (found['size'], found['size'], found['spp'], found['max_bounces'],
                                                   found['reference_spp'], min(loads), max(loads)),
             '', ', '.join('%s: %s' % item for item in versions.items()), '',
             *_renderers_table(found), '', *_ratios_table(found), '']
    return '\n'.join(lines)
