"""Making a dataset, in several processes, whatever ends them.

settings      how it is made; none of it decides a sample
maker         what makes samples; library_maker, from probes, objects and a renderer
produce       all shards that are not there yet
shard_task    a worker's task: one shard; attempts, of one sample; spool, what a kill does not cost
losses        what becomes of a shard whose worker died or hung
progress      what a run tells
description   dataset.json, and whether a folder may go on with it
repeat        one sample alone
estimate      how long and how large, without making it
"""
