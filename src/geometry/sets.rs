//! Disjoint sets, led by the lowest item: the result does not depend on the order of joining.

/// Disjoint sets of the items `0..count`, joined two at a time. 4 bytes an item.
#[derive(Debug, Clone)]
pub(crate) struct Sets {
    parent: Vec<u32>,
}

impl Sets {
    /// Creates a set for every item.
    pub fn new(count: usize) -> Self {
        Self { parent: (0..count as u32).collect() }
    }

    /// Returns the lowest item of the item's set. Shortens the way there.
    #[inline]
    pub fn find(&mut self, mut item: u32) -> u32 {
        loop {
            let parent = self.parent[item as usize];
            if parent == item {
                return item;
            }
            let above = self.parent[parent as usize];
            self.parent[item as usize] = above;
            item = above;
        }
    }

    /// Joins the sets of two items. Returns whether they were different.
    #[inline]
    pub fn join(&mut self, a: u32, b: u32) -> bool {
        let (a, b) = (self.find(a), self.find(b));
        self.parent[a.max(b) as usize] = a.min(b);
        a != b
    }

    /// Number of items.
    pub fn len(&self) -> usize {
        self.parent.len()
    }

    /// Number of sets. O(n).
    pub fn count(&self) -> usize {
        self.parent.iter().enumerate().filter(|&(item, &parent)| item as u32 == parent).count()
    }
}

#[cfg(test)]
mod tests {
    use super::Sets;

    #[test]
    fn the_lowest_item_leads() {
        let mut sets = Sets::new(5);
        assert!(sets.join(4, 2) && sets.join(2, 1) && !sets.join(1, 4));
        assert_eq!([0, 1, 2, 3, 4].map(|item| sets.find(item)), [0, 1, 1, 3, 1]);
        assert_eq!((sets.len(), sets.count()), (5, 3));
    }
}
