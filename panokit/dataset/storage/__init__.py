"""A dataset on disk: shards, their index, reading, and whether all is whole.

layout         where everything lies, and which samples go into which shard
members        files of a sample as bytes; decode, as arrays; member_table, what there is
shards         tar files, the same bytes for the same samples
index          one row for each sample; index_columns, what they say
read           random access; sampling, in which order
verify         whether a dataset is whole; sample_checks, whether a sample is
"""
